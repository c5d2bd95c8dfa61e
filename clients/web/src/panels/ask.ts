// SPDX-License-Identifier: GPL-3.0-or-later
// Asks the user before something is lost. Without an answer, or with Escape, nothing is lost.
import { text } from '../text/text';
import { button, element } from './dom';

export function ask(question: string, consequence: string, yes: string): Promise<boolean> {
  return new Promise((resolve) => {
    const dialog = element('dialog', { class: 'ask', aria: { label: question } });
    const answer = (sure: boolean) => (): void => {
      dialog.close();
      dialog.remove();
      resolve(sure);
    };
    const keep = button(text.ask.cancel, answer(false), { autofocus: true });
    dialog.append(
      element('p', { class: 'question' }, question),
      element('p', {}, consequence),
      element('div', { class: 'buttons' }, keep, button(yes, answer(true), { class: 'danger' })),
    );
    dialog.addEventListener('cancel', (event) => {
      event.preventDefault();
      answer(false)();
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}
