// SPDX-License-Identifier: GPL-3.0-or-later
// Shows where to cut first: a pulsing ring on the tissue, and a dot that shows the stroke. The cue disappears when tissue
// was heated or cut, and comes back when the tissue is whole again.
import { Vector3 } from 'three';

import { pick } from '../model/pick';
import { hasHeat } from '../model/tool_parts';
import type { Control } from '../model/control';
import type { Viewport } from '../scene/viewport';
import { text } from '../text/text';
import { byId } from './dom';

const REACH = 0.17; // half length of the stroke, as a share of the width of the tissue
const SVG = 'http://www.w3.org/2000/svg';
const PROPERTIES = ['fx', 'fy', 'tx', 'ty'] as const;

interface Stroke {
  from: Vector3;
  to: Vector3;
}

/** Across the middle of the tissue, on what is on top there. */
function strokeOf(viewport: Viewport): Stroke | null {
  const { tissue } = viewport;
  const all = tissue?.joined.surroundings?.all;
  if (!tissue || !all) return null;
  const [least, most] = [new Vector3(...all.least), new Vector3(...all.most)];
  const [middle, size] = [least.clone().add(most).multiplyScalar(0.5), most.clone().sub(least)];
  const on = (share: number): Vector3 | null => {
    const over = new Vector3(middle.x + share * size.x, middle.y, most.z + size.x);
    const hit = pick(over.toArray(), [0, 0, -1], tissue.position.array as Float32Array, tissue.visibleIndices());
    return hit && over.setZ(over.z - hit.distance);
  };
  const [from, to] = [on(-REACH), on(REACH)];
  return from && to && { from, to };
}

function draw(place: HTMLElement): void {
  const svg = document.createElementNS(SVG, 'svg');
  svg.setAttribute('aria-hidden', 'true');
  for (const [tag, name] of [['line', 'stroke'], ['circle', 'ring'], ['circle', 'still'], ['circle', 'runner']] as const) {
    const shape = document.createElementNS(SVG, tag);
    shape.setAttribute('class', name);
    if (tag === 'circle') shape.setAttribute('r', name === 'runner' ? '6' : '11');
    svg.append(shape);
  }
  place.append(svg, Object.assign(document.createElement('p'), { id: 'cue-words' }));
}

/** Returns what keeps the cue on the tissue; called once per animation frame. */
export function showCue(control: Control, viewport: Viewport): () => void {
  const { model } = control;
  const place = byId('cue');
  draw(place);
  const words = place.querySelector('p')!;
  words.textContent = window.matchMedia('(pointer: coarse)').matches ? text.cue.touch : text.cue.press;
  const line = place.querySelector('line')!;
  let stroke: Stroke | null = null;
  let shown = '';
  /** epochs in which a tool has been hot, and for which the stroke was laid */
  let heatedIn: string | null = null;
  let laidIn: string | null = null;
  const wanted = (): boolean => {
    const { frame, tool, timeline, joined } = model;
    if (!frame || !tool || !joined || !timeline || !model.mayOperate || frame.faulted) return false;
    if (!hasHeat(tool.shape) || (model.driver !== null && !model.driving)) return false;
    return frame.epoch !== heatedIn && !timeline.events.some(({ kind }) => kind === 'cut');
  };
  const refresh = (): void => {
    const { frame } = model;
    if (frame?.tools.some(({ energized }) => energized)) heatedIn = frame.epoch;
    const show = wanted();
    if (show && laidIn !== frame!.epoch) {
      stroke = strokeOf(viewport);
      laidIn = frame!.epoch;
    }
    place.hidden = !show || stroke === null;
  };
  for (const event of ['frame', 'timeline', 'tools', 'link'] as const) model.on(event, refresh);
  model.on('joined', () => {
    stroke = laidIn = heatedIn = null;
    place.hidden = true;
  });
  return () => {
    if (place.hidden || !stroke) return;
    // For each picture of the animation the browser composes the whole page again.
    const seldom = viewport.pace?.laboured === true;
    if (place.classList.contains('seldom') !== seldom) place.classList.toggle('seldom');
    const box = viewport.canvas.getBoundingClientRect();
    const [from, to] = [viewport.project(stroke.from.toArray()), viewport.project(stroke.to.toArray())];
    const at = [from.x - box.left, from.y - box.top, to.x - box.left, to.y - box.top].map((value) => value.toFixed(1));
    if (at.join() === shown) return;
    shown = at.join();
    PROPERTIES.forEach((name, i) => place.style.setProperty(`--${name}`, `${at[i]}px`));
    ['x1', 'y1', 'x2', 'y2'].forEach((name, i) => line.setAttribute(name, at[i]));
  };
}
