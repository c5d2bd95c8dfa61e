// SPDX-License-Identifier: GPL-3.0-or-later
// The section for pedal, gamepad and 3D mouse: their state, and buttons that connect them.
import { keyWords, type Pedal } from '../hands/pedal';
import type { SpaceMouse } from '../hands/space_mouse';
import { attempt, button, element, problemPlace } from './dom';

function pedalPart(pedal: Pedal): HTMLElement {
  const words = element('p', { class: 'about', id: 'pedal', aria: { role: 'status' } });
  const choose = button('Choose the pedal’s key', () => {
    words.textContent = 'Press the pedal now.';
    pedal.choose((problem) => {
      if (problem === null) show();
      else words.textContent = problem;
    });
  });
  const forget = button('Forget the pedal', () => {
    pedal.forget();
    show();
  });
  const show = (): void => {
    const { code } = pedal;
    words.textContent = code === null ? 'The browser sees a foot pedal as a key. Choose that key here.' : `The pedal is the key ${keyWords(code)}. Energy is on while the pedal is down.`;
    forget.hidden = code === null;
  };
  show();
  return element('div', { class: 'form' }, words, element('div', { class: 'buttons' }, choose, forget));
}

export function devicesSection(pedal: Pedal, makeMouse: (changed: () => void) => SpaceMouse): HTMLElement {
  const problem = problemPlace();
  const words = element('p', { class: 'about', id: 'space-mouse', aria: { role: 'status' } });
  const show = (): void => {
    words.textContent = !mouse.offered
      ? 'A 3D mouse needs a browser with WebHID, such as Chromium or Edge.'
      : mouse.name === null
        ? 'The cap of a 3D mouse moves the tool, and its first button turns energy on. The browser asks which device it may use. Choose the mouse there.'
        : `${mouse.name} moves the tool. Energy is on while its first button is held.`;
    choose.hidden = !mouse.offered;
  };
  const choose = button('Choose the 3D mouse', () => void attempt(problem, () => mouse.choose(), choose));
  const mouse = makeMouse(() => show());
  const gamepad = element('p', { class: 'about' }, 'A gamepad works as soon as you press one of its buttons. The sticks move the tool, and the right trigger turns energy on.');
  show();
  return element(
    'details',
    { class: 'section', id: 'devices' },
    element('summary', {}, 'Pedal, gamepad, 3D mouse'),
    element('div', { class: 'form' }, pedalPart(pedal), gamepad, words, choose, problem),
  );
}
