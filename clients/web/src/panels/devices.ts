// SPDX-License-Identifier: GPL-3.0-or-later
// Pedal, gamepad, 3D mouse: what the page knows of them, and how they are made known to it.
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
    words.textContent = code === null ? 'A foot pedal is a keyboard to the browser. Choose here which key it presses.' : `The pedal is ${keyWords(code)}: energy while it is down.`;
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
        ? 'A 3D mouse leads the tool with its cap; its first button is energy. The browser asks which device it may use: only a person can answer that.'
        : `${mouse.name} leads the tool; its first button is energy while held.`;
    choose.hidden = !mouse.offered;
  };
  const choose = button('Choose the 3D mouse', () => void attempt(problem, () => mouse.choose(), choose));
  const mouse = makeMouse(() => show());
  const gamepad = element('p', { class: 'about' }, 'A gamepad works as soon as one of its buttons is pressed: sticks lead, the right trigger is energy.');
  show();
  return element(
    'details',
    { class: 'section', id: 'devices' },
    element('summary', {}, 'Pedal, gamepad, 3D mouse'),
    element('div', { class: 'form' }, pedalPart(pedal), gamepad, words, choose, problem),
  );
}
