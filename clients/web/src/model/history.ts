// SPDX-License-Identifier: GPL-3.0-or-later
// What the tools did since this page watches the session: temperature, force and energy of each, thinned
// so that any length of it has room. Going back in time forgets what is no longer so.
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

/** Half of them stay when they are this many: an hour at 60 a second is then told 7 times a second. */
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
  /** of `every` moments one is kept */
  private every = 1;
  private sinceKept = 0;

  get moments(): readonly Moment[] {
    return this.kept;
  }

  /** Names of all tools that there were, in the order in which they came. */
  get tools(): readonly string[] {
    return [...this.names];
  }

  take(moment: Moment): void {
    const last = this.kept.at(-1);
    if (last && moment.tick <= last.tick) {
      this.forgetFrom(moment.tick);
      this.sinceKept = this.every; // it stands for what was forgotten, or is the same tick told again
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

  /** The newest moment that is not after a tick. */
  at(tick: number): Moment | null {
    const i = this.firstFrom(tick + 1);
    return this.kept[i - 1] ?? null;
  }

  private forgetFrom(tick: number): void {
    this.kept.length = this.firstFrom(tick);
  }

  /** Index of the first moment at or after a tick. */
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
