// SPDX-License-Identifier: GPL-3.0-or-later
// Invites others to the session, by a link to copy or to photograph. The link holds the access token of this tab.
import { encode } from 'uqr';

import { tokenFragment } from '../model/kept_token';
import type { Model } from '../model/model';
import { text } from '../text/text';
import { button, element } from './dom';

const EDGE = 2; // white modules around the code, which cameras need

function joinLink(model: Model, token: string | undefined): string {
  const link = new URL(window.location.pathname, window.location.href);
  if (model.session !== null) link.searchParams.set('session', model.session);
  if (token !== undefined) link.hash = tokenFragment(token);
  return link.href;
}

function picture(link: string): SVGElement {
  const { data, size } = encode(link, { border: EDGE });
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', `0 0 ${size} ${size}`);
  svg.setAttribute('class', 'code');
  svg.setAttribute('role', 'img');
  svg.setAttribute('aria-label', text.invite.code);
  const dark = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  const squares = data.flatMap((row, y) => row.map((filled, x) => (filled ? `M${x} ${y}h1v1h-1z` : '')));
  dark.setAttribute('d', squares.join(''));
  svg.append(dark);
  return svg;
}

/** A button that shows the link, to copy or to photograph. */
export function inviteButton(model: Model, token: () => string | undefined): HTMLButtonElement {
  return button(text.invite.title, () => {
    const own = token();
    const link = joinLink(model, own);
    const shown = element('input', { readOnly: true, value: link, aria: { label: text.invite.link } });
    const said = element('p', { class: 'about', aria: { role: 'status' } });
    const copy = button(text.invite.copy, () => {
      shown.select();
      void navigator.clipboard.writeText(link).then(() => (said.textContent = text.invite.copied), () => (said.textContent = text.invite.notCopied));
    }, { autofocus: true });
    const warning = own === undefined ? text.invite.joins : text.invite.holdsToken;
    const dialog = element('dialog', { class: 'ask', id: 'invite', aria: { label: text.invite.title } },
      element('p', { class: 'question' }, text.invite.title), element('p', {}, warning), picture(link), shown, said,
      element('div', { class: 'buttons' }, copy, button(text.invite.close, () => dialog.close())));
    dialog.addEventListener('close', () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
  }, { class: 'invite' });
}
