// SPDX-License-Identifier: GPL-3.0-or-later
// Shows values under the pointer: layer, vertex, position, temperature, stress, heat exposure.
import { pick } from '../model/pick';
import type { Control } from '../model/control';
import type { Viewport } from '../scene/viewport';
import type { VertexState } from '../wire/worker_messages';
import { text } from '../text/text';
import { byId, check, short } from './dom';

const AGAIN_MS = 200; // refresh while the pointer rests, because the tissue changes
const AWAY_PX = 18;
const MM = 1000;

interface Found {
  layer: string;
  /** whether stress is known: the daemon sends stress of fat, whose membrane has the same vertices */
  stressed: boolean;
  vertex: number;
}

function find(viewport: Viewport, x: number, y: number): Found | null {
  const { tissue, orbit } = viewport;
  if (!tissue) return null;
  const { origin, direction } = orbit.ray(x, y);
  const hit = pick(origin.toArray(), direction.toArray(), tissue.position.array as Float32Array, tissue.visibleIndices(), viewport.clip.away(origin, direction));
  if (!hit) return null;
  const { layer, kind } = tissue.joined.batches[hit.batch];
  return { layer, vertex: hit.vertex, stressed: kind === 'fat' || kind === 'membrane' };
}

function words({ layer, vertex, stressed }: Found, state: VertexState, position: ArrayLike<number>): string {
  const at = [0, 1, 2].map((c) => (MM * position[3 * vertex + c]).toFixed(1)).join(', ');
  const temperature = state.temperatureC === null ? '' : `${state.temperatureC.toFixed(1)} °C`;
  const stress = state.stressPa === null ? '' : stressed ? `${short(state.stressPa / 1000, 3)} kPa` : text.inspect.fatOnly;
  const heat = text.inspect.exposure(Math.round(100 * state.exposure));
  return [text.inspect.vertex(layer, vertex), `${at} mm`, temperature, stress, heat].filter((part) => part !== '').join('\n');
}

/** Returns the switch, and a function that turns it off. */
export function showInspected(control: Control, viewport: Viewport): { switch: HTMLElement; off: () => void } {
  const { canvas } = viewport;
  const place = byId('inspected');
  let on = false;
  let pointer: { x: number; y: number } | null = null;
  let asking = false;
  const tell = async (): Promise<void> => {
    if (!on || !pointer || asking) return;
    const box = canvas.getBoundingClientRect();
    const { x, y } = pointer;
    const found = find(viewport, (2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height);
    asking = true;
    const state = found && (await control.link.inspect(found.vertex));
    asking = false;
    // Meanwhile the pointer may have left the tissue, or the user turned the switch off.
    place.hidden = !on || !pointer || !found || !state || !viewport.tissue;
    if (place.hidden || !found || !state || !viewport.tissue) return;
    place.textContent = words(found, state, viewport.tissue.position.array);
    const left = Math.min(x - box.left + AWAY_PX, box.width - place.offsetWidth);
    const top = Math.min(y - box.top + AWAY_PX, box.height - place.offsetHeight);
    place.style.transform = `translate(${left.toFixed(0)}px, ${top.toFixed(0)}px)`;
  };
  canvas.addEventListener('pointermove', (event) => {
    pointer = { x: event.clientX, y: event.clientY };
    void tell();
  });
  canvas.addEventListener('pointerleave', () => {
    pointer = null;
    place.hidden = true;
  });
  setInterval(() => void tell(), AGAIN_MS);
  const set = (now: boolean): void => {
    on = now;
    place.hidden = true;
    control.inspect(now);
  };
  const box = check(text.inspect.show, 'inspect', set);
  const off = (): void => {
    box.querySelector('input')!.checked = false;
    set(false);
  };
  return { switch: box, off };
}
