// SPDX-License-Identifier: GPL-3.0-or-later
// Tests smoke that drifts and clears, and the sounds of instruments.
import { Puffs } from '../../../../clients/web/src/model/puffs';
import { heardOf, heartbeatLost, modeOf, TONE_HZ } from '../../../../clients/web/src/model/sounds';
import type { Tool } from '../../../../clients/web/src/wire/messages.gen';
import type { ToolState } from '../../../../clients/web/src/wire/records';

const STEP_S = 1 / 60;
const TIP = [0.01, 0, 0.002] as const;
const half = (): number => 0.5;

function burnt(seconds: number, faces = 0): Puffs {
  const puffs = new Puffs(half);
  for (let i = 0; i < seconds / STEP_S; i++) {
    if (i % 60 === 0) puffs.burst(faces);
    puffs.advance(STEP_S, [TIP]);
  }
  return puffs;
}

describe('smoke', () => {
  it('comes while tissue burns, and more of it where elements are removed', () => {
    expect(new Puffs(half).advance(1, [])).toBe(false);
    const heating = burnt(2).count;
    expect(heating).toBeGreaterThan(5);
    expect(burnt(2, 10).count).toBeGreaterThan(heating + 4);
  });

  it('is not there where faces go without heat', () => {
    const puffs = new Puffs(half);
    puffs.burst(100);
    expect(puffs.advance(STEP_S, [])).toBe(false);
    expect(puffs.advance(STEP_S, [TIP])).toBe(false); // a later step has no smoke either
  });

  it('rises and drifts aside, and clears', () => {
    const puffs = burnt(1.5);
    const oldest = Array.from(puffs.position.subarray(0, 3));
    expect(oldest[2]).toBeGreaterThan(TIP[2] + 0.01);
    expect(Math.hypot(oldest[0] - TIP[0], oldest[1] - TIP[1])).toBeGreaterThan(0.001);
    let seconds = 0;
    while (puffs.advance(STEP_S, []) && seconds < 60) seconds += STEP_S;
    expect(seconds).toBeGreaterThan(1);
    expect(seconds).toBeLessThan(6);
    expect(puffs.count).toBe(0);
  });
});

const tool = (more: Partial<Tool>): Tool => ({ name: 'it', shape: 'hook', ...more });
const state = (more: Partial<ToolState>): ToolState => ({ name: 'it', energized: true, touchedLayers: 0, energyOff: 'never_enabled', ...more }) as ToolState;

describe('sounds', () => {
  it('tell modes by their tones', () => {
    expect(modeOf(tool({}))).toBe('cut');
    expect(modeOf(tool({ crest_factor: 8 }))).toBe('coagulate');
    expect(modeOf(tool({ shape: 'bipolar', crest_factor: 8 }))).toBe('bipolar');
    expect(modeOf(tool({ shape: 'shears' }))).toBe('ultrasonic');
    const tones = Object.values(TONE_HZ).sort((one, other) => one - other);
    for (let i = 1; i < tones.length; i++) expect(tones[i] / tones[i - 1]).toBeGreaterThan(1.25);
  });

  it('are there only while energy is on, and sizzle only where tissue is touched', () => {
    expect(heardOf([tool({})], [state({ energized: false, touchedLayers: 1 })], 9)).toEqual({ toneHz: 0, sizzle: 0 });
    expect(heardOf([tool({})], [state({})], 9)).toEqual({ toneHz: 660, sizzle: 0 });
    const [quiet, loud] = [0, 9].map((faces) => heardOf([tool({})], [state({ touchedLayers: 1 })], faces).sizzle);
    expect(quiet).toBeGreaterThan(0);
    expect(loud).toBe(1);
  });

  it('alarm where the watchdog cut energy off, once, and not where a hand did', () => {
    const [on, cut, off] = [state({}), state({ energized: false, energyOff: 'watchdog' }), state({ energized: false, energyOff: 'commanded' })];
    expect(heartbeatLost([on], [cut])).toBe(true);
    expect(heartbeatLost([cut], [cut])).toBe(false);
    expect(heartbeatLost([on], [off])).toBe(false);
    expect(heartbeatLost([], [cut])).toBe(false);
  });
});
