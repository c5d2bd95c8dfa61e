// SPDX-License-Identifier: GPL-3.0-or-later
// The section for pedal, gamepad and 3D mouse: their state, and buttons that connect them.
import { keyWords, type Pedal } from '../hands/pedal';
import type { SpaceMouse } from '../hands/space_mouse';
import { text } from '../text/text';
import { attempt, button, element, problemPlace } from './dom';

function pedalPart(pedal: Pedal): HTMLElement {
  const words = element('p', { class: 'about', id: 'pedal', aria: { role: 'status' } });
  const choose = button(text.devices.choosePedal, () => {
    words.textContent = text.devices.pressPedal;
    pedal.choose((problem) => {
      if (problem === null) show();
      else words.textContent = problem;
    });
  });
  const forget = button(text.devices.forgetPedal, () => {
    pedal.forget();
    show();
  });
  const show = (): void => {
    const { code } = pedal;
    words.textContent = code === null ? text.devices.noPedal : text.devices.pedal(keyWords(code));
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
      ? text.devices.noWebHid
      : mouse.name === null
        ? text.devices.noMouse
        : text.devices.mouse(mouse.name);
    choose.hidden = !mouse.offered;
  };
  const choose = button(text.devices.chooseMouse, () => void attempt(problem, () => mouse.choose(), choose));
  const mouse = makeMouse(() => show());
  const gamepad = element('p', { class: 'about' }, text.devices.gamepad);
  show();
  return element(
    'details',
    { class: 'section', id: 'devices' },
    element('summary', {}, text.devices.title),
    element('div', { class: 'form' }, pedalPart(pedal), gamepad, words, choose, problem),
  );
}
