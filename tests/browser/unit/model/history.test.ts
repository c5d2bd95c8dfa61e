// SPDX-License-Identifier: GPL-3.0-or-later
import { History, type Moment } from '../../../../clients/web/src/model/history';

const moment = (tick: number): Moment => ({ tick, tools: new Map([['hook', { temperatureC: tick, forceN: 0, energyJ: 2 * tick }]]) });

describe('history', () => {
  it('tells the newest moment that is not after a tick', () => {
    const history = new History();
    for (const tick of [10, 12, 15]) history.take(moment(tick));
    expect(history.at(9)).toBeNull();
    expect(history.at(10)?.tick).toBe(10);
    expect(history.at(14)?.tick).toBe(12);
    expect(history.at(1000)?.tools.get('hook')?.energyJ).toBe(30);
    expect(history.tools).toEqual(['hook']);
  });

  it('forgets what a rewind has undone', () => {
    const history = new History();
    for (let tick = 0; tick < 100; tick++) history.take(moment(tick));
    history.take(moment(40));
    expect(history.moments.map(({ tick }) => tick)).toEqual(Array.from({ length: 41 }, (_, i) => i));
  });

  it('takes a tick that is told again for the newest of it, however thinned', () => {
    const history = new History();
    const ticks = 300_000;
    for (let tick = 0; tick < ticks; tick++) history.take(moment(tick));
    const { tick } = history.moments.at(-1)!;
    history.take({ ...moment(tick), tools: new Map([['hook', { temperatureC: 5, forceN: 6, energyJ: 7 }]]) });
    expect(history.at(tick)?.tick).toBe(tick);
    expect(history.at(tick)?.tools.get('hook')?.forceN).toBe(6);
    expect(history.moments.filter((one) => one.tick === tick)).toHaveLength(1);
  });

  it('has room for any length, and keeps the beginning and the end of it', () => {
    const history = new History();
    const ticks = 300_000;
    for (let tick = 0; tick < ticks; tick++) history.take(moment(tick));
    expect(history.moments.length).toBeLessThan(32_768);
    expect(history.moments.length).toBeGreaterThan(8_000);
    expect(history.moments[0].tick).toBe(0);
    expect(ticks - history.moments.at(-1)!.tick).toBeLessThan(40);
    const steps = history.moments.slice(1).map(({ tick }, i) => tick - history.moments[i].tick);
    expect(Math.max(...steps)).toBeLessThan(2 * Math.min(...steps) + 1);
  });
});
