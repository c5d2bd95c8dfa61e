// SPDX-License-Identifier: GPL-3.0-or-later
import { momentsOf } from '../../../../clients/web/src/model/moments';
import type { TimelineEvent } from '../../../../clients/web/src/wire/messages.gen';

const seconds = (tick: number): string => `${(tick / 60).toFixed(2)} s`;
const event = (kind: TimelineEvent['kind'], tick: number, tool?: string): TimelineEvent =>
  ({ kind, tick, ...(tool === undefined ? {} : { tool }) }) as TimelineEvent;

describe('what happened', () => {
  it('joins cuts of one tool that nothing else parts', () => {
    const events = [event('energy_on', 60, 'hook'), ...[90, 91, 99, 150].map((tick) => event('cut', tick, 'hook')), event('cut', 160, 'blade'), event('energy_off', 180, 'hook')];
    expect(momentsOf(events, seconds)).toEqual([
      { tick: 180, words: '3.00 s: energy off, hook' },
      { tick: 160, words: '2.67 s: cut, blade' },
      { tick: 90, words: '1.50 to 2.50 s: cut, hook' },
      { tick: 60, words: '1.00 s: energy on, hook' },
    ]);
  });

  it('names the vessel that it happened to', () => {
    const events = (['bleeding', 'bleeding_stopped', 'sealed'] as const).map((kind, i) => ({ ...event(kind, 60 * i), detail: 'artery' }));
    expect(momentsOf(events, seconds).map(({ words }) => words)).toEqual(['2.00 s: vessel sealed, artery', '1.00 s: bleeding stopped, artery', '0.00 s: bleeding, artery']);
  });

  it('joins nothing else', () => {
    expect(momentsOf([event('snapshot', 0), event('snapshot', 60)], seconds).map(({ words }) => words)).toEqual(['1.00 s: snapshot', '0.00 s: snapshot']);
  });
});
