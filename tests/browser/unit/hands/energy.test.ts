// SPDX-License-Identifier: GPL-3.0-or-later
// Tests energy that is held here and turned off elsewhere. The page says so at once, and what turns it on again. Only a
// new press turns it on, and a release never turns off energy that another input has turned on.
import { Energy, LATCH_S } from '../../../../clients/web/src/hands/energy';
import { Holds, type Held } from '../../../../clients/web/src/hands/holds';
import type { Control } from '../../../../clients/web/src/model/control';
import { Model, type Said } from '../../../../clients/web/src/model/model';
import type { EnergyOff, ToolState } from '../../../../clients/web/src/wire/records';
import type { Frame } from '../../../../clients/web/src/wire/worker_messages';

const ME = 7;

/** A command about energy that the page has sent. answer() and refuse() resolve when the page has taken the daemon's
 * answer. */
interface Told {
  energized: boolean;
  /** limit in ticks that the command has */
  ticks: number | undefined;
  /** tick for which the command was ordered */
  tick: number | undefined;
  answer(tick: number): Promise<void>;
  refuse(words: string): Promise<void>;
}

/** Resolves after everything that an answer causes: timers run after that. */
const taken = (): Promise<void> => new Promise((resolve) => setTimeout(resolve));

/** A model and a control that have only what energy uses. */
class Bench {
  readonly model = new Model();
  readonly told: Told[] = [];
  readonly said = new Map<string, string>();
  readonly holds = new Holds();
  readonly energy: Energy;
  /** number of times that a latch has ended without an input */
  ends = 0;

  constructor() {
    const { model } = this;
    model.hello = { client: ME, role: 'operate' } as Model['hello'];
    model.link = { state: 'online', hello: model.hello!, again: false };
    model.selectedTool = 'hook';
    this.driver(ME);
    model.on('said', ({ key, words }: Said) => this.said.set(key ?? '', words));
    model.on('unsaid', (key) => this.said.delete(key));
    const call = (_method: string, { energized, ticks, tick: ordered }: { energized: boolean; ticks?: number; tick?: number }): Promise<unknown> =>
      new Promise((resolve, reject) => {
        this.told.push({
          energized,
          ticks,
          tick: ordered,
          answer: (tick) => (resolve({ tick }), taken()),
          refuse: (words) => (reject(new Error(words)), taken()),
        });
      });
    this.energy = new Energy(model, { call } as unknown as Control, () => 1, this.holds, () => this.ends++);
  }

  driver(client: number): void {
    this.model.drivers.set('hook', { tool: 'hook', client, name: 'Birch 27, viewer 0.1.0', energized: false, energy_off: 'commanded' });
    this.model.emit('tools', undefined);
  }

  press(by: Held = 'space'): void {
    this.hold(by);
    this.energy.enable('hook', true);
  }

  hold(by: Held): void {
    this.holds.take({ type: 'press', by, id: by, place: null, ripe: true });
    if (by === 'latch') this.energy.limitByLatch();
  }

  release(by: Held): void {
    const why = this.holds.take({ type: 'release', id: by });
    if (why) this.energy.off(why);
  }

  frame(tick: number, energized: boolean, energyOff: EnergyOff = 'commanded', more: Partial<Frame> = {}): void {
    const tool = { name: 'hook', energized, energyOff } as ToolState;
    const frame = { epoch: 'e', tick, paused: false, tools: [tool], samples: [], ...more } as unknown as Frame;
    this.model.frame = frame;
    this.model.emit('frame', frame);
  }

  /** Presses at tick 10 and gets the answer, so that energy is on. */
  async lit(by: Held = 'space'): Promise<void> {
    this.frame(10, false);
    this.press(by);
    await this.told[0].answer(11);
    this.frame(12, true);
    expect(this.energy.alive).toBe(true);
    expect(this.said.size).toBe(0);
  }
}

describe('energy that is held', () => {
  it.each([
    ['space', 'Release Space and press it again.'],
    ['trigger', 'Release the trigger and pull it again.'],
    ['pointer', 'Lift and press again.'],
  ] as const)('cut by the watchdog while %s is down: said with the next frame, with what brings it back', async (by, again) => {
    const bench = new Bench();
    await bench.lit(by);
    bench.frame(40, false, 'watchdog');
    expect(bench.said.get('energy')).toContain('Energy is off: the server did not hear from this page in time');
    expect(bench.said.get('energy')).toContain(again);
    expect(bench.energy.alive).toBe(false);
    bench.energy.enable('hook', false); // a key that is still held turns nothing on again
    expect(bench.told.length).toBe(1);
    bench.release(by);
    expect(bench.said.size).toBe(0);
    bench.press(by);
    expect(bench.energy.alive).toBe(true);
  });

  it('cut before it ever came on is said too', async () => {
    const bench = new Bench();
    bench.frame(10, false, 'never_enabled');
    bench.press();
    await bench.told[0].answer(11);
    bench.frame(11, false, 'never_enabled'); // frame before the step for which energy was ordered
    expect(bench.said.size).toBe(0);
    bench.frame(12, false, 'never_enabled');
    expect(bench.said.get('energy')).toContain('before it came on');
  });

  it('refused is said in the daemon’s words', async () => {
    const bench = new Bench();
    bench.press();
    await bench.told[0].refuse('the store is full');
    expect(bench.said.get('energy')).toBe('Energy is off: the store is full. Release Space and press it again.');
  });

  it('a late answer to an earlier press does not count', async () => {
    const bench = new Bench();
    bench.frame(10, false);
    bench.press();
    bench.release('space');
    bench.press();
    await bench.told[0].answer(11);
    bench.frame(12, false);
    expect(bench.energy.alive).toBe(true);
    expect(bench.said.size).toBe(0);
  });

  it.each([
    ['paused', 13, { paused: true }, 'the session is paused'],
    ['rewound', 3, { epoch: 'f' }, 'was rewound or restarted'],
  ] as const)('%s: says so', async (_name, tick, more, words) => {
    const bench = new Bench();
    await bench.lit();
    bench.frame(tick, false, 'restored', more);
    expect(bench.said.get('energy')).toContain(words);
  });

  it('in a paused session is not asked for, and says why', () => {
    const bench = new Bench();
    bench.frame(10, false, 'commanded', { paused: true });
    bench.press('pointer');
    expect(bench.told.length).toBe(0);
    expect(bench.said.get('energy')).toBe('Energy is off: the session is paused. Lift and press again.');
  });

  it('taken over: says by whom, and letting go leaves the other’s energy on', async () => {
    const bench = new Bench();
    await bench.lit();
    bench.driver(ME + 1);
    expect(bench.said.get('energy')).toContain('Birch 27 took the tool over');
    bench.release('space');
    expect(bench.told.length).toBe(1);
  });

  it('a lost connection is said', async () => {
    const bench = new Bench();
    await bench.lit();
    bench.model.setLink({ state: 'lost', words: 'gone', retryInS: 1 });
    expect(bench.said.get('energy')).toContain('the connection was lost');
  });

  it('stays on until the last of two holds ends', async () => {
    const bench = new Bench();
    await bench.lit();
    bench.hold('pointer');
    bench.release('space');
    expect(bench.energy.alive).toBe(true);
    bench.release('pointer');
    expect(bench.told.at(-1)?.energized).toBe(false);
    expect(bench.energy.alive).toBe(false);
  });
});

describe('energy that is latched', () => {
  const TICKS = 60 * LATCH_S;

  it('has a limit that goes with the enable', async () => {
    const bench = new Bench();
    await bench.lit('latch');
    expect(bench.told.map(({ energized, ticks, tick }) => [energized, ticks, tick])).toEqual([[true, TICKS, undefined]]);
    expect(bench.energy.latched).toBe(true);
    bench.frame(11 + TICKS - 60, true);
    expect(bench.energy.latchedForS).toBe(1);
    bench.frame(11 + TICKS, false);
    expect(bench.said.get('')).toBe(`Energy is off: Keep on lasts ${LATCH_S} s at most. Press Keep on again to continue.`);
    expect([bench.energy.latched, bench.energy.wanted, bench.energy.alive]).toEqual([false, false, false]);
    expect(bench.ends).toBe(1);
  });

  it('by whom holds something already has the limit from then on', async () => {
    const bench = new Bench();
    await bench.lit('space');
    bench.hold('latch');
    bench.release('space');
    expect(bench.energy.alive).toBe(true);
    expect(bench.told.at(-1)).toMatchObject({ energized: true, ticks: TICKS });
  });

  it('ends where somebody ends it, at once, whatever else is held', async () => {
    const bench = new Bench();
    await bench.lit('latch');
    bench.press('pointer');
    bench.release('latch');
    expect(bench.told.at(-1)).toMatchObject({ energized: false, tick: undefined });
    expect([bench.energy.latched, bench.energy.alive]).toEqual([false, false]);
    expect(bench.said.size).toBe(0);
  });

  it('ends with whatever cuts energy, and is not on when that comes back', async () => {
    const bench = new Bench();
    await bench.lit('latch');
    bench.frame(40, false, 'watchdog');
    expect(bench.said.get('')).toContain('the server did not hear from this page in time. A busy computer can cause this. Press Keep on again to continue.');
    expect(bench.energy.latched).toBe(false);
    bench.press('space');
    bench.release('space');
    expect(bench.energy.alive).toBe(false);
  });

  it.each([['pointer', 'commanded'], ['space', 'watchdog'], ['latch', 'commanded'], ['trigger', 'restored']] as const)(
    'does not come on again by itself: %s, %s, at any later tick',
    async (by, energyOff) => {
      const bench = new Bench();
      await bench.lit('latch');
      bench.release('latch');
      bench.frame(100, false);
      bench.press(by);
      await bench.told.at(-1)!.answer(101);
      bench.frame(102, true);
      const enables = (): number => bench.told.filter(({ energized }) => energized).length;
      expect(enables()).toBe(2);
      for (const tick of [103, 10 + TICKS, 11 + TICKS, 12 + TICKS, 101 + TICKS, 200 + TICKS]) bench.frame(tick, false, energyOff);
      expect(enables()).toBe(2);
      expect(bench.energy.alive).toBe(false);
    },
  );

  it('is not taken in a paused session', () => {
    const bench = new Bench();
    bench.frame(10, false, 'commanded', { paused: true });
    bench.press('latch');
    expect(bench.told.filter(({ energized }) => energized)).toEqual([]);
    expect(bench.energy.latched).toBe(false);
    expect(bench.said.get('')).toContain('the session is paused');
  });
});
