// SPDX-License-Identifier: GPL-3.0-or-later
// The ruler over the picture, with its length in millimetres.
import type { Ruler } from '../hands/ruler';
import type { Viewport } from '../scene/viewport';
import { text } from '../text/text';
import { button, byId, element } from './dom';

const SVG = 'http://www.w3.org/2000/svg';
const MM = 1000;

/** Returns a function that updates the ruler; called once per animation frame. */
export function showRuler(ruler: Ruler, viewport: Viewport): () => void {
  const place = byId('ruler');
  const svg = document.createElementNS(SVG, 'svg');
  const line = document.createElementNS(SVG, 'line');
  svg.setAttribute('aria-hidden', 'true');
  svg.append(line);
  const words = element('output');
  const away = button('×', () => ruler.clear(), { aria: { label: text.ruler.remove } });
  const label = element('p', {}, words, away);
  place.append(svg, label);
  let shown = '';
  return () => {
    const { from, to, length } = ruler;
    const hidden = from === null || to === null || length === null;
    if (place.hidden !== hidden) place.hidden = hidden;
    if (!from || !to || length === null) return;
    const box = viewport.canvas.getBoundingClientRect();
    const ends = [from, to].map((end) => viewport.project(end.toArray())).flatMap(({ x, y }) => [x - box.left, y - box.top]);
    const now = ends.map((value) => value.toFixed(1)).join();
    if (now === shown) return;
    shown = now;
    ['x1', 'y1', 'x2', 'y2'].forEach((name, i) => line.setAttribute(name, ends[i].toFixed(1)));
    words.value = `${(MM * length).toFixed(1)} mm`;
    label.style.transform = `translate(${((ends[0] + ends[2]) / 2).toFixed(0)}px, ${((ends[1] + ends[3]) / 2).toFixed(0)}px)`;
  };
}
