// SPDX-License-Identifier: GPL-3.0-or-later
// What is heard of an instrument: a tone while it is activated, by its mode; a sizzle while tissue burns; an alarm when
// energy was cut off because no heartbeat came. From states alone; scene/sound.ts makes them audible.
import type { Tool } from '../wire/messages.gen';
import type { ToolState } from '../wire/records';

export type Mode = 'cut' | 'coagulate' | 'bipolar' | 'ultrasonic';

/** Tones, Hz. They differ by a major third or more, so that a user recognises each tone alone. */
export const TONE_HZ: Readonly<Record<Mode, number>> = { bipolar: 520, cut: 660, coagulate: 940, ultrasonic: 1250 };

/** Crest factor from which a voltage comes in bursts and does not cut. */
const BURSTS_FROM = 3;
const FACES_LOUDEST = 6; // removed faces between two frames at which the sizzle is loudest

export function modeOf(tool: Tool): Mode {
  if (tool.shape === 'bipolar') return 'bipolar';
  if (tool.shape === 'shears') return 'ultrasonic';
  return (tool.crest_factor ?? 0) >= BURSTS_FROM ? 'coagulate' : 'cut';
}

export interface Heard {
  /** Hz; 0: none */
  toneHz: number;
  /** 0 to 1 */
  sizzle: number;
}

/** removedFaces: since the frame before. Of several instruments with energy on the first one is heard. */
export function heardOf(tools: readonly Tool[], states: readonly ToolState[], removedFaces: number): Heard {
  const on = states.filter(({ energized }) => energized);
  const tool = tools.find(({ name }) => name === on[0]?.name);
  const burning = on.some(({ touchedLayers }) => touchedLayers !== 0);
  return { toneHz: tool ? TONE_HZ[modeOf(tool)] : 0, sizzle: burning ? Math.min(0.3 + (0.7 * removedFaces) / FACES_LOUDEST, 1) : 0 };
}

/** Whether energy of an instrument went off between two frames because no heartbeat of its driver came. */
export function heartbeatLost(before: readonly ToolState[], now: readonly ToolState[]): boolean {
  return now.some((state) => state.energyOff === 'watchdog' && !state.energized && before.some((old) => old.name === state.name && old.energized));
}
