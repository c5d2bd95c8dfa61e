// SPDX-License-Identifier: GPL-3.0-or-later
// The dialog for the access token. It shows beside the input why a token was not accepted. The user can open the dialog
// again after closing it. Password managers find a name and a password in it.
import type { Model } from '../model/model';
import { text } from '../text/text';
import { button, element, field, problemPlace } from './dom';

/** Returns a function that opens the dialog. */
export function askForToken(model: Model, connect: (token: string) => void): () => void {
  const token = element('input', { type: 'password', name: 'password', id: 'token-input', autocomplete: 'current-password', required: true });
  const user = element('input', { type: 'text', name: 'username', value: 'cautery', autocomplete: 'username', readOnly: true, class: 'unseen', tabIndex: -1, aria: { hidden: 'true' } });
  const problem = problemPlace();
  const submit = element('button', { type: 'submit' }, text.token.connect);
  const form = element('form', { class: 'form' }, user, field(text.token.label, token), problem, element('div', { class: 'buttons' }, submit, button(text.token.close, () => dialog.close())));
  const dialog = element('dialog', { id: 'token', class: 'ask', aria: { label: text.token.label } }, element('p', {}, text.token.about), form);
  document.body.append(dialog);
  let given = false;
  const open = (): void => {
    if (!dialog.open) dialog.showModal();
    token.focus();
  };
  const busy = (working: boolean): void => {
    submit.disabled = working;
    submit.ariaBusy = String(working);
  };
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    given = true;
    problem.hidden = true;
    busy(true);
    connect(token.value.trim());
  });
  model.on('link', (link) => {
    if (link.state === 'online') {
      token.value = '';
      given = false;
      dialog.close();
    }
    if (link.state === 'connecting') return;
    busy(false);
    if (link.state === 'lost' && given) say(text.token.lost(link.words));
    if (link.state !== 'refused' || link.status !== 'unauthorized') return;
    open();
    if (!given) return;
    say(text.token.refused);
    token.select();
  });
  const say = (words: string): void => {
    problem.textContent = words;
    problem.hidden = false;
  };
  return open;
}
