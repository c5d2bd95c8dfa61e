// SPDX-License-Identifier: GPL-3.0-or-later
// Switches for smoke and sounds; the browser stores them.
import type { Sound, Sounds } from '../scene/sound';
import type { Viewport } from '../scene/viewport';
import { check, element } from './dom';

type Sense = Sound | 'smoke';
const SENSES: readonly (readonly [Sense, string])[] = [['smoke', 'Smoke'], ['tone', 'Activation tone'], ['sizzle', 'Sizzle'], ['alarm', 'Alarm when the connection fails']];
const KEPT = 'off'; // key of the names that are off, separated by commas

export function sensesSection(viewport: Viewport, sounds: Sounds): HTMLElement {
  const off = new Set((localStorage.getItem(KEPT) ?? '').split(','));
  const turn = (sense: Sense, on: boolean): void => {
    if (sense === 'smoke') viewport.smoke.turn(on);
    else sounds.turn(sense, on);
  };
  const boxes = SENSES.map(([sense, words]) => {
    turn(sense, !off.has(sense));
    return check(words, sense, (on) => {
      if (on) off.delete(sense);
      else off.add(sense);
      localStorage.setItem(KEPT, SENSES.map(([name]) => name).filter((name) => off.has(name)).join(','));
      turn(sense, on);
    }, !off.has(sense));
  });
  return element('section', { aria: { label: 'Smoke and sound' } }, element('h2', {}, 'Smoke and sound'), ...boxes);
}
