// SPDX-License-Identifier: GPL-3.0-or-later
// Switches for smoke and sounds; the browser stores them.
import type { Sound, Sounds } from '../scene/sound';
import type { Viewport } from '../scene/viewport';
import { text } from '../text/text';
import { check, element } from './dom';

type Sense = Sound | 'smoke';
const SENSES: readonly Sense[] = ['smoke', 'tone', 'sizzle', 'alarm'];
const KEPT = 'off'; // key of the names that are off, separated by commas

export function sensesSection(viewport: Viewport, sounds: Sounds): HTMLElement {
  const off = new Set((localStorage.getItem(KEPT) ?? '').split(','));
  const turn = (sense: Sense, on: boolean): void => {
    if (sense === 'smoke') viewport.smoke.turn(on);
    else sounds.turn(sense, on);
  };
  const boxes = SENSES.map((sense) => {
    turn(sense, !off.has(sense));
    return check(text.senses.switches[sense], sense, (on) => {
      if (on) off.delete(sense);
      else off.add(sense);
      localStorage.setItem(KEPT, SENSES.filter((name) => off.has(name)).join(','));
      turn(sense, on);
    }, !off.has(sense));
  });
  return element('section', { aria: { label: text.senses.title } }, element('h2', {}, text.senses.title), ...boxes);
}
