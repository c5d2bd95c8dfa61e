// SPDX-License-Identifier: GPL-3.0-or-later
// The buttons of the tool over the picture: the effect of a press, energy, jaws, depth.
import { depthWords } from '../hands/depth';
import { LATCH_S } from '../hands/energy';
import { keyId, pointerId } from '../hands/holds';
import type { Pointer, Press } from '../hands/pointer';
import type { ToolHand } from '../hands/tool_hand';
import type { Control } from '../model/control';
import { hasHeat, hasJaws } from '../model/tool_parts';
import { text } from '../text/text';
import { button, byId, element } from './dom';

const DEPTH_STEP_M = 0.001;
const PRESSES: readonly Press[] = ['work', 'move', 'look', 'measure', 'pin'];

const RESEARCH: readonly Press[] = ['measure', 'pin'];

function pressChoice(control: Control, pointer: Pointer): HTMLElement {
  const group = element('div', { class: 'choice', aria: { role: 'group', label: text.handles.presses } });
  const buttons = PRESSES.map((press) => {
    const choose = button(text.handles.press[press].name, () => {
      pointer.press = press;
      show();
    }, { title: text.handles.press[press].title, class: RESEARCH.includes(press) ? 'research-only' : '', data: { press }, aria: { pressed: String(press === pointer.press) } });
    return choose;
  });
  const show = (): void => {
    for (const one of buttons) one.setAttribute('aria-pressed', String(one.dataset['press'] === pointer.press));
  };
  group.append(...buttons);
  control.model.on('tools', () => {
    show();
    const { tool } = control.model;
    const words = !tool || hasHeat(tool.shape) ? text.handles.press.work.name : text.handles.grasp;
    if (buttons[0].textContent !== words) buttons[0].textContent = words;
  });
  return group;
}

function energyButton(control: Control, hand: ToolHand): HTMLButtonElement {
  const { model } = control;
  const energy = button(text.handles.energy, () => undefined, { id: 'energy', class: 'energy', aria: { pressed: 'false' } });
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
    energy.title = hand.usable ? text.handles.energyTitle : text.handles.notYours;
  });
  const around = byId('picture').parentElement;
  model.on('frame', () => {
    const on = model.toolState?.energized === true;
    if (energy.getAttribute('aria-pressed') === String(on)) return;
    energy.setAttribute('aria-pressed', String(on));
    energy.textContent = on ? text.handles.energyOn : text.handles.energy;
    around?.classList.toggle('hot', on);
  });
  return energy;
}

/** The button Keep on, with a sign in the picture that shows how long energy stays on. */
function latchButton(control: Control, hand: ToolHand): HTMLButtonElement {
  const { model } = control;
  const sign = byId('latched');
  const latch = button(text.handles.latch, () => hand.latch(), { id: 'latch', class: 'latch', aria: { pressed: 'false' } });
  const show = (): void => {
    const { latched, alive } = hand.energy;
    const on = latched && alive;
    if (latch.getAttribute('aria-pressed') !== String(on)) latch.setAttribute('aria-pressed', String(on));
    if (sign.hidden === on) sign.hidden = !on;
    if (!on) return;
    const words = text.handles.latched(Math.ceil(hand.energy.latchedForS));
    if (sign.textContent !== words) sign.textContent = words;
  };
  model.on('tools', () => {
    latch.hidden = model.tool !== null && !hasHeat(model.tool.shape);
    latch.disabled = !hand.usable;
    latch.title = hand.usable ? text.handles.latchTitle(LATCH_S) : text.handles.notYours;
    show();
  });
  model.on('frame', show);
  return latch;
}

function depthGroup(control: Control, hand: ToolHand): HTMLElement {
  const { model } = control;
  const nearer = button('−', () => hand.nudge(0, 0, DEPTH_STEP_M), { aria: { label: text.handles.nearer }, title: text.handles.nearerTitle });
  const deeper = button('+', () => hand.nudge(0, 0, -DEPTH_STEP_M), { aria: { label: text.handles.deeper }, title: text.handles.deeperTitle });
  const depth = button('', () => hand.resetDepth(), { id: 'depth', title: text.handles.depthTitle });
  const refresh = (): void => {
    const words = depthWords(hand.depthM);
    depth.textContent = words;
    depth.setAttribute('aria-label', text.handles.depthLabel(words));
    for (const one of [nearer, depth, deeper]) one.disabled = !model.driving;
  };
  model.on('tools', refresh);
  refresh();
  return element('div', { class: 'choice', aria: { role: 'group', label: text.handles.depth } }, nearer, depth, deeper);
}

export function showHandles(control: Control, hand: ToolHand, pointer: Pointer): void {
  const { model } = control;
  const grasp = button(text.handles.grasp, () => hand.jaws.grasp(model.toolState?.grasping !== true), { id: 'grasp', aria: { pressed: 'false' } });
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
