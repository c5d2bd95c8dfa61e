// SPDX-License-Identifier: GPL-3.0-or-later
// Messages at the tool or at the pointer: why the tool does not move, why energy went off, how to continue.
import type { Pointer } from '../hands/pointer';
import type { Model, Said } from '../model/model';
import type { Viewport } from '../scene/viewport';
import { button, byId, element } from './dom';

const SHOWN_MS = 5000;
const LINES_MAX = 3;
const AWAY_PX = 26; // from the tip, so that a finger or the tool does not cover the words
const MARGIN_PX = 8;

/** Returns a function that updates the position of the messages; called once per animation frame. */
export function showSaid(model: Model, viewport: Viewport, pointer: Pointer): () => void {
  const place = byId('said');
  const lines = new Map<string, HTMLElement>();
  let transient = 0;
  const put = (): void => {
    if (lines.size === 0) return;
    const picture = viewport.canvas.getBoundingClientRect();
    const tip = model.driving ? model.toolState?.positionM : undefined;
    const at = tip ? viewport.project(tip) : (pointer.last ?? { x: picture.left + picture.width / 2, y: picture.top + picture.height / 3 });
    const { width, height } = place.getBoundingClientRect();
    const x = Math.min(Math.max(at.x - picture.left - width / 2, MARGIN_PX), Math.max(picture.width - width - MARGIN_PX, MARGIN_PX));
    const above = at.y - picture.top - height - AWAY_PX;
    const y = Math.min(above >= MARGIN_PX ? above : at.y - picture.top + 2 * AWAY_PX, picture.height - height - MARGIN_PX);
    place.style.transform = `translate(${x.toFixed(0)}px, ${Math.max(y, MARGIN_PX).toFixed(0)}px)`;
  };
  const remove = (key: string): void => {
    lines.get(key)?.remove();
    lines.delete(key);
  };
  /** Returns whether a message with this key and text is already shown; then only its figures are changed. */
  const changeFigures = ({ words, key, figures }: Said): boolean => {
    const line = key === undefined ? undefined : lines.get(key);
    const place_ = line?.querySelector('.figures');
    if (!place_ || line?.dataset['words'] !== words) return false;
    if (place_.textContent !== figures) place_.textContent = figures ?? '';
    return true;
  };
  const add = (said: Said): void => {
    const { kind, words, key, figures, action } = said;
    if (changeFigures(said)) return;
    for (const [other, line] of lines) if (line.dataset['words'] === words) remove(other);
    const name = key ?? `transient ${transient++}`;
    remove(name);
    const line = element('p', { class: `said-line ${kind}`, data: { words } }, figures === undefined ? words : `${words} `);
    if (figures !== undefined) line.append(element('span', { class: 'figures', aria: { live: 'off' } }, figures));
    if (action) {
      line.append(button(action.words, () => {
        remove(name);
        action.press();
      }));
    }
    lines.set(name, line);
    place.append(line);
    for (const old of [...lines.keys()].slice(0, -LINES_MAX)) remove(old);
    put(); // at once: on a slow machine the next frame is a while away, and the words stood where the last ones were
    if (key === undefined) setTimeout(() => lines.get(name) === line && remove(name), action ? 2 * SHOWN_MS : SHOWN_MS);
  };
  model.on('said', add);
  model.on('unsaid', remove);
  return put;
}
