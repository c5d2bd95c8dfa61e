// SPDX-License-Identifier: GPL-3.0-or-later
// Plays every pair of hold_table.ts on one page. After each loss of the hold, the command that turns energy off must
// leave the page within 100 ms. No command may turn energy on again until the next press.
import type { Door } from './door';
import type { HoldHands } from './hold_hands';
import { LOSSES, WAYS, type Loss, type Places, type Way } from './hold_table';

const LIMIT_MS = 100;
const PLAYS = 10; // largest number of plays of a pair
const STAYS_TICKS = 5;
const BODY_C = 37; // temperature of a tip that heats nothing: hundreds of presses leave the tissue whole
const PATIENCE_MS = 8_000;

export const PAIRS = WAYS.flatMap((way) =>
  LOSSES.flatMap((loss) => (loss.does(way) === null ? [] : [[way.name, loss.name, loss.does(way)!, way, loss] as const])));

interface Order {
  energized: boolean;
  /** time when the order passed, ms since 1970 */
  at: number;
}

/** The daemon turned energy off, because a slow machine delayed the page for longer than a driver may be silent. */
class EndedByDaemon extends Error {}

/** Notes the commands about energy that pass a door. */
class Wire {
  readonly orders: Order[] = [];
  private look = (): void => undefined;

  constructor(door: Door) {
    door.heard = (method, params) => {
      if (method !== 'tool.energize') return;
      this.orders.push({ energized: params['energized'] === true, at: performance.timeOrigin + performance.now() });
      this.look();
    };
  }

  /** Returns the first order with this value of `energized`, from index `from` of the list on. */
  order(from: number, energized: boolean): Promise<Order> {
    return new Promise((resolve, reject) => {
      const late = setTimeout(() => reject(new Error(`no order ${energized ? 'on' : 'off'} came`)), PATIENCE_MS);
      this.look = () => {
        const found = this.orders.slice(from).find((order) => order.energized === energized);
        if (!found) return;
        clearTimeout(late);
        this.look = () => undefined;
        resolve(found);
      };
      this.look();
    });
  }
}

export class HoldStage {
  private readonly wire: Wire;
  private places!: Places;
  readonly latencies: number[] = [];

  constructor(
    readonly hands: HoldHands,
    door: Door,
  ) {
    this.wire = new Wire(door);
  }

  /** Takes the tool, gives it a tip that heats nothing, and finds the places to press. */
  async prepare(): Promise<void> {
    const { hands } = this;
    await this.until(() => window.cautery?.tick > 0 && document.querySelector('#panel-tools .take') !== null, null);
    await hands.evaluate(() => document.querySelector<HTMLElement>('#panel-tools .take')!.click(), null);
    await this.until(() => window.cautery.driving, null);
    await hands.evaluate((celsius) => {
      document.querySelector<HTMLInputElement>('#panel-tools input[name=temperature_c]')!.value = String(celsius);
      [...document.querySelectorAll<HTMLElement>('#panel-tools button')].find(({ textContent }) => textContent === 'Apply')!.click();
    }, BODY_C);
    await this.until((celsius) => window.cautery.tool?.temperature_c === celsius, BODY_C);
    // the veil says that there is no WebGL
    await hands.evaluate(() => document.getElementById('veil')!.style.setProperty('display', 'none'), null);
    this.places = await hands.evaluate(() => {
      const middle = (id: string): { x: number; y: number } => {
        const { x, y, width, height } = document.getElementById(id)!.getBoundingClientRect();
        return { x: Math.round(x + width / 2), y: Math.round(y + height / 2) };
      };
      const { x, y } = window.cautery.project([-0.01, 0.005, 0]);
      return { tissue: { x: Math.round(x), y: Math.round(y) }, energy: middle('energy'), latch: middle('latch') };
    }, null);
  }

  /** Plays a pair, again if it was too slow. On a busy machine the fastest play is nearest to the page's own time. */
  async pair(way: Way, loss: Loss, does: 'off' | 'stays'): Promise<void> {
    let fastest = Infinity;
    for (let played = 0; played < PLAYS && fastest > LIMIT_MS; played++)
      fastest = Math.min(fastest, await this.play(way, loss, does).catch((error: unknown) => {
        if (error instanceof EndedByDaemon) return Infinity;
        throw error;
      }));
    expect(fastest, 'ms until the command was sent').toBeLessThan(LIMIT_MS);
    if (does === 'off') this.latencies.push(fastest);
  }

  /** Returns the milliseconds from the loss to the command; 0 if the hold stays. */
  private async play(way: Way, loss: Loss, does: 'off' | 'stays'): Promise<number> {
    const { hands, wire, places } = this;
    const from = wire.orders.length;
    let latency = 0;
    try {
      await way.begin(hands, places);
      await wire.order(from, true);
      if (loss === LOSSES[0]) await this.until(() => window.cautery.energized, null);
      await hands.evaluate(() => void (window.holds.at = null), null);
      await loss.happen(hands, way, places);
      if (does === 'off') latency = await this.expectOff(from);
      else await this.expectOn(from);
      if (loss === LOSSES[0]) await this.until(() => !window.cautery.energized, null);
    } finally {
      await loss.undo?.(hands, way);
      await this.tidy(way);
    }
    await wire.order(from + 1, false);
    expect(wire.orders.slice(from).filter(({ energized }) => energized).length, 'no press, no energy').toBe(1);
    return latency;
  }

  /** Reports the slowest time, and checks that all pairs were counted. */
  report(browser: string): void {
    const sorted = [...this.latencies].sort((a, b) => a - b);
    expect(sorted.length).toBe(PAIRS.filter(([, , does]) => does === 'off').length);
    process.stdout.write(`${PAIRS.length} pairs in ${browser}: off within ${sorted.at(-1)!.toFixed(1)} ms, half within ${sorted[sorted.length >> 1].toFixed(1)} ms\n`);
  }

  private async expectOff(from: number): Promise<number> {
    const off = await this.wire.order(from + 1, false).catch(async (error: unknown) => {
      if (await this.hands.evaluate(() => window.cautery.energized, null)) throw error;
      throw new EndedByDaemon();
    });
    const lost = await this.hands.evaluate(() => window.holds.at, null);
    expect(lost).not.toBe(null);
    return off.at - lost!;
  }

  private async expectOn(from: number): Promise<void> {
    const tick = await this.hands.evaluate(() => window.cautery.tick, null);
    await this.until((then) => window.cautery.tick >= then, tick + STAYS_TICKS);
    expect(this.wire.orders.length).toBe(from + 1);
  }

  /** Releases everything that is pressed. */
  private async tidy({ kind, release }: Way): Promise<void> {
    const { hands, places } = this;
    if (kind !== 'latch') await release(hands, places);
    await hands.up('touch');
    await hands.keyDown('Escape');
    await hands.keyUp('Escape');
  }

  private async until<A>(condition: (argument: A) => boolean, argument: A): Promise<void> {
    const end = Date.now() + PATIENCE_MS;
    while (!(await this.hands.evaluate(condition, argument))) {
      if (Date.now() > end) throw new Error(`never came true: ${String(condition)}`);
      await this.hands.evaluate(() => new Promise<void>((resolve) => requestAnimationFrame(() => resolve())), null);
    }
  }
}
