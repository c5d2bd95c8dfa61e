// SPDX-License-Identifier: GPL-3.0-or-later
// Invites others to the session, by a link to copy or to photograph. The link holds the access token of this tab.
import { encode } from 'uqr';

import { tokenFragment } from '../model/kept_token';
import type { Model } from '../model/model';
import { button, element } from './dom';

const EDGE = 2; // white modules around the code, which cameras need

function joinLink(model: Model, token: string | undefined): string {
  const link = new URL(window.location.pathname, window.location.href);
  if (model.session !== null) link.searchParams.set('session', model.session);
  if (token !== undefined) link.hash = tokenFragment(token);
  return link.href;
}

function picture(text: string): SVGElement {
  const { data, size } = encode(text, { border: EDGE });
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', `0 0 ${size} ${size}`);
  svg.setAttribute('class', 'code');
  svg.setAttribute('role', 'img');
  svg.setAttribute('aria-label', 'The link as a QR code');
  const dark = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  const squares = data.flatMap((row, y) => row.map((filled, x) => (filled ? `M${x} ${y}h1v1h-1z` : '')));
  dark.setAttribute('d', squares.join(''));
  svg.append(dark);
  return svg;
}

/** A button that shows the link, to copy or to photograph. */
export function inviteButton(model: Model, token: () => string | undefined): HTMLButtonElement {
  return button('Invite others', () => {
    const own = token();
    const link = joinLink(model, own);
    const text = element('input', { readOnly: true, value: link, aria: { label: 'Link to this session' } });
    const said = element('p', { class: 'about', aria: { role: 'status' } });
    const copy = button('Copy the link', () => {
      text.select();
      void navigator.clipboard.writeText(link).then(() => (said.textContent = 'Copied.'), () => (said.textContent = 'This browser does not allow pages to copy. Press Ctrl+C.'));
    }, { autofocus: true });
    const warning = own === undefined ? 'Anyone who opens this link joins this session.' : 'This link contains your access token. Anyone who has the link can do what you can. Give it only to people you trust.';
    const dialog = element('dialog', { class: 'ask', id: 'invite', aria: { label: 'Invite others' } },
      element('p', { class: 'question' }, 'Invite others'), element('p', {}, warning), picture(link), text, said,
      element('div', { class: 'buttons' }, copy, button('Close', () => dialog.close())));
    dialog.addEventListener('close', () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
  }, { class: 'invite' });
}
