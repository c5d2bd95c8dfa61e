// SPDX-License-Identifier: GPL-3.0-or-later
import { Vector3 } from 'three';

import { Depths, depthWords } from '../../../../clients/web/src/hands/depth';
import { Way } from '../../../../clients/web/src/hands/way';

const at = (x: number): Vector3 => new Vector3(x, 0, 0);

describe('the way of a tool', () => {
  it('is gone whole, however quickly the hand drew it, and no faster than the tool may', () => {
    const way = new Way();
    for (const x of [0.01, 0.02, 0.03]) way.append(at(x));
    way.append(new Vector3(0.03, 0.01, 0));
    const tool = at(0);
    expect(way.follow(tool, 0.025)).toBe(0);
    expect(tool.x).toBeCloseTo(0.025, 12);
    way.follow(tool, 0.01);
    expect(tool.toArray()).toEqual([expect.closeTo(0.03, 12), expect.closeTo(0.005, 12), 0]); // through the corner
    expect(way.follow(tool, 0.015)).toBeCloseTo(0.01, 12);
    expect(way.empty).toBe(true);
  });

  it('is dropped when the hand goes straight to a place, or lets go', () => {
    const way = new Way();
    way.append(at(0.01));
    way.append(at(0.02));
    way.to(at(-0.01));
    expect(way.rest().map(({ x }) => x)).toEqual([-0.01]);
    way.clear();
    expect(way.follow(at(0), 1)).toBe(1);
  });

  it('is bounded: more of it draws its end in', () => {
    const way = new Way();
    for (let i = 0; i < 5000; i++) way.append(at(0.001 * i));
    expect(way.rest().length).toBeLessThanOrEqual(400);
    expect(way.rest().at(-1)?.x).toBeCloseTo(4.999, 9);
  });
});

describe('depth', () => {
  it('is each tool’s own, bounded, and reset alone', () => {
    const depths = new Depths();
    depths.change('hook', 0.002);
    depths.change('grasper', -0.001);
    depths.change('spatula', 1);
    expect([depths.of('hook'), depths.of('grasper'), depths.of('needle'), depths.of(null)]).toEqual([0.002, -0.001, 0, 0]);
    expect(depths.of('spatula')).toBe(0.03);
    depths.reset('hook');
    expect([depths.of('hook'), depths.of('grasper')]).toEqual([0, -0.001]);
  });

  it.each([[0, 'at the surface'], [0.00004, 'at the surface'], [0.0015, '1.5 mm deep'], [-0.006, '6.0 mm above']])('%f m is %s', (depth, words) => {
    expect(depthWords(depth)).toBe(words);
  });
});
