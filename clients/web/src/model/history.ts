// SPDX-License-Identifier: GPL-3.0-or-later
// The history of the tools since this page watches the session: temperature, force and energy of each tool. It is thinned
// out to a limited size. A rewind removes all later points.
import type { ToolState } from '../wire/records';

export interface ToolMoment {
  temperatureC: number;
  forceN: number;
  energyJ: number;
}

export interface Moment {
  tick: number;
  tools: ReadonlyMap<string, ToolMoment>;
}

/** Largest number of moments; then every second one is removed. An hour at 60 a second is kept with 7 a second. */
const MOMENTS_MAX = 32_768;

export function momentOf(tick: number, tools: readonly ToolState[]): Moment {
  return {
    tick,
    tools: new Map(tools.map(({ name, tipTemperatureC, forceN, energyJ }) => [name, { temperatureC: tipTemperatureC, forceN: Math.hypot(...forceN), energyJ }])),
  };
}

export class History {
  private kept: Moment[] = [];
  private readonly names = new Set<string>();
  /** one of `every` moments is kept */
  private every = 1;
  private sinceKept = 0;

  get moments(): readonly Moment[] {
    return this.kept;
  }

  /** Returns the names of all tools of the history, in the order in which they came. */
  get tools(): readonly string[] {
    return [...this.names];
  }

  take(moment: Moment): void {
    const last = this.kept.at(-1);
    if (last && moment.tick <= last.tick) {
      this.forgetFrom(moment.tick);
      this.sinceKept = this.every; // this moment replaces removed moments, or the same tick
    }
    if (++this.sinceKept < this.every) return;
    this.sinceKept = 0;
    for (const name of moment.tools.keys()) this.names.add(name);
    this.kept.push(moment);
    if (this.kept.length < MOMENTS_MAX) return;
    this.kept = this.kept.filter((_, i) => i % 2 === 0);
    this.every *= 2;
  }

  clear(): void {
    this.kept = [];
    this.names.clear();
    this.every = 1;
    this.sinceKept = 0;
  }

  /** Returns the newest moment at or before a tick. */
  at(tick: number): Moment | null {
    const i = this.firstFrom(tick + 1);
    return this.kept[i - 1] ?? null;
  }

  private forgetFrom(tick: number): void {
    this.kept.length = this.firstFrom(tick);
  }

  /** Returns the index of the first moment at or after a tick. */
  private firstFrom(tick: number): number {
    let [low, high] = [0, this.kept.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.kept[middle].tick < tick) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}
