// SPDX-License-Identifier: GPL-3.0-or-later
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

import { cuttingSpeed } from '../../../../clients/web/src/hands/cutting_pace';
import type { Scene, Tool } from '../../../../clients/web/src/wire/messages.gen';

const scene = (name: string): Scene => JSON.parse(readFileSync(fileURLToPath(new URL(`../../../../deploy/scenes/${name}.json`, import.meta.url)), 'utf8')) as Scene;
const hook = (celsius: number): Tool => ({ name: 'hook', shape: 'hook', hot_radius_m: 0.003, tip_length_m: 0.008, temperature_c: celsius });

describe('the pace of a cut', () => {
  it.each(['fascia', 'layers'])('is that of the scripted cut of %s, which parts it', (name) => {
    const { cut } = scene(name);
    const { metresPerS, stayS } = cuttingSpeed(scene(name), hook(170));
    expect(metresPerS / (cut?.speed_m_s ?? NaN)).toBeGreaterThan(0.8);
    expect(metresPerS / (cut?.speed_m_s ?? NaN)).toBeLessThan(1.2);
    expect(Math.abs(stayS - (cut?.dwell_s ?? NaN))).toBeLessThan(0.6);
  });

  it('is faster the hotter the tip, within bounds', () => {
    const speeds = [100, 165, 170, 200, 400, 2000].map((celsius) => cuttingSpeed(scene('fascia'), hook(celsius)).metresPerS);
    expect([...speeds].sort((a, b) => a - b)).toEqual(speeds);
    expect(speeds[0]).toBe(0.001);
    expect(speeds.at(-1)).toBe(0.01);
  });

  it('is bounded where nothing says when tissue parts', () => {
    expect(cuttingSpeed({ name: 'bare' }, hook(170)).metresPerS).toBe(0.01);
  });
});
