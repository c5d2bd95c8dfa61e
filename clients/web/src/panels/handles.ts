// SPDX-License-Identifier: GPL-3.0-or-later
// The buttons of the tool over the picture: the effect of a press, energy, jaws, depth.
import { depthWords } from '../hands/depth';
import { LATCH_S } from '../hands/energy';
import { keyId, pointerId } from '../hands/holds';
import type { Pointer, Press } from '../hands/pointer';
import type { ToolHand } from '../hands/tool_hand';
import type { Control } from '../model/control';
import { hasHeat, hasJaws } from '../model/tool_parts';
import { button, byId, element } from './dom';

const DEPTH_STEP_M = 0.001;
const PRESSES: readonly (readonly [Press, string, string])[] = [
  ['work', 'Cut', 'Press on the tissue to cut; energy is on until you release'],
  ['move', 'Move', 'Press on the tissue to move the tool there without energy'],
  ['look', 'Look', 'Drag to turn the view; the tool does not move'],
  ['measure', 'Measure', 'Drag over the tissue to measure a distance; the tool does not move'],
  ['pin', 'Pin', 'Drag over the tissue to pin it within 5 mm of the pointer; the tool does not move'],
];

const RESEARCH: readonly Press[] = ['measure', 'pin'];

function pressChoice(control: Control, pointer: Pointer): HTMLElement {
  const group = element('div', { class: 'choice', aria: { role: 'group', label: 'What a press on the tissue does' } });
  const buttons = PRESSES.map(([press, words, title]) => {
    const choose = button(words, () => {
      pointer.press = press;
      show();
    }, { title, class: RESEARCH.includes(press) ? 'research-only' : '', data: { press }, aria: { pressed: String(press === pointer.press) } });
    return choose;
  });
  const show = (): void => {
    for (const one of buttons) one.setAttribute('aria-pressed', String(one.dataset['press'] === pointer.press));
  };
  group.append(...buttons);
  control.model.on('tools', () => {
    show();
    const { tool } = control.model;
    const words = !tool || hasHeat(tool.shape) ? 'Cut' : 'Grasp';
    if (buttons[0].textContent !== words) buttons[0].textContent = words;
  });
  return group;
}

function energyButton(control: Control, hand: ToolHand): HTMLButtonElement {
  const { model } = control;
  const energy = button('Energy', () => undefined, { id: 'energy', class: 'energy', aria: { pressed: 'false' } });
  const press = (id: string): void => hand.take({ type: 'press', by: 'button', id, place: 'energy', ripe: true });
  energy.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    energy.focus(); // a second finger on the picture moves the focus away again, which does not end the hold
    energy.setPointerCapture(event.pointerId);
    press(pointerId(event.pointerId));
  });
  energy.addEventListener('mousedown', (event) => event.preventDefault()); // some browsers would move the focus away
  energy.addEventListener('keydown', (event) => {
    if ((event.code === 'Space' || event.code === 'Enter') && !event.repeat) press(keyId(event.code));
  });
  energy.addEventListener('contextmenu', (event) => event.preventDefault());
  model.on('tools', () => {
    energy.hidden = model.tool !== null && !hasHeat(model.tool.shape);
    energy.disabled = !hand.usable;
    energy.title = hand.usable ? 'Hold this button, or Space, to turn energy on' : 'Only the person who uses the tool can turn energy on';
  });
  const around = byId('picture').parentElement;
  model.on('frame', () => {
    const on = model.toolState?.energized === true;
    if (energy.getAttribute('aria-pressed') === String(on)) return;
    energy.setAttribute('aria-pressed', String(on));
    energy.textContent = on ? 'Energy on' : 'Energy';
    around?.classList.toggle('hot', on);
  });
  return energy;
}

/** The button Keep on, with a sign in the picture that shows how long energy stays on. */
function latchButton(control: Control, hand: ToolHand): HTMLButtonElement {
  const { model } = control;
  const sign = byId('latched');
  const latch = button('Keep on', () => hand.latch(), { id: 'latch', class: 'latch', aria: { pressed: 'false' } });
  const show = (): void => {
    const { latched, alive } = hand.energy;
    const on = latched && alive;
    if (latch.getAttribute('aria-pressed') !== String(on)) latch.setAttribute('aria-pressed', String(on));
    if (sign.hidden === on) sign.hidden = !on;
    if (!on) return;
    const words = `Energy stays on for ${Math.ceil(hand.energy.latchedForS)} s. Press Keep on, L or Escape to turn energy off.`;
    if (sign.textContent !== words) sign.textContent = words;
  };
  model.on('tools', () => {
    latch.hidden = model.tool !== null && !hasHeat(model.tool.shape);
    latch.disabled = !hand.usable;
    latch.title = hand.usable ? `Keep energy on without holding, for at most ${LATCH_S} s (L)` : 'Only the person who uses the tool can turn energy on';
    show();
  });
  model.on('frame', show);
  return latch;
}

function depthGroup(control: Control, hand: ToolHand): HTMLElement {
  const { model } = control;
  const nearer = button('−', () => hand.nudge(0, 0, DEPTH_STEP_M), { aria: { label: 'Nearer' }, title: 'Nearer (S)' });
  const deeper = button('+', () => hand.nudge(0, 0, -DEPTH_STEP_M), { aria: { label: 'Deeper' }, title: 'Deeper (W)' });
  const depth = button('', () => hand.resetDepth(), { id: 'depth', title: 'Depth of the tool. Press to return the tool to the surface.' });
  const refresh = (): void => {
    const words = depthWords(hand.depthM);
    depth.textContent = words;
    depth.setAttribute('aria-label', `Depth: ${words}. Press to return to the surface.`);
    for (const one of [nearer, depth, deeper]) one.disabled = !model.driving;
  };
  model.on('tools', refresh);
  refresh();
  return element('div', { class: 'choice', aria: { role: 'group', label: 'Depth' } }, nearer, depth, deeper);
}

export function showHandles(control: Control, hand: ToolHand, pointer: Pointer): void {
  const { model } = control;
  const grasp = button('Grasp', () => hand.jaws.grasp(model.toolState?.grasping !== true), { id: 'grasp', aria: { pressed: 'false' } });
  byId('handles').append(pressChoice(control, pointer), energyButton(control, hand), latchButton(control, hand), grasp, depthGroup(control, hand));
  model.on('tools', () => {
    grasp.hidden = !model.tool || !hasJaws(model.tool.shape);
    grasp.disabled = !hand.jaws.usable;
  });
  model.on('frame', () => {
    const grasps = String(model.toolState?.grasping === true);
    if (grasp.getAttribute('aria-pressed') !== grasps) grasp.setAttribute('aria-pressed', grasps);
  });
  model.emit('tools', undefined);
}
