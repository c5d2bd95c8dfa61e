// SPDX-License-Identifier: GPL-3.0-or-later
import { figuresOf, stateWords, VesselWatch } from '../../../../clients/web/src/model/vessel_words';
import type { VesselState } from '../../../../clients/web/src/wire/vessels';

const WHOLE: VesselState = {
  name: 'artery', parted: false, pierced: false, shut: false, sealed: false, bleeds: false,
  radiusM: 0.001, bleedingM3S: 0, shedM3: 0, burstPa: 0, points: new Float32Array(0),
};
const BLEEDING: VesselState = { ...WHOLE, parted: true, bleeds: true, bleedingM3S: 4.94e-6, shedM3: 12.4e-6 };
const SEALED: VesselState = { ...WHOLE, sealed: true, shut: true, burstPa: 1e5 };
const NEWS_S = 6;

describe('a vessel in words', () => {
  it('has all that holds of it', () => {
    expect([WHOLE, BLEEDING, SEALED].map(stateWords)).toEqual(['open', 'parted, bleeding', 'sealed, pressed shut']);
    expect(stateWords({ ...WHOLE, pierced: true })).toBe('wall has a hole');
  });

  it('has millilitres and millimetres of mercury', () => {
    expect([WHOLE, BLEEDING, SEALED].map(figuresOf)).toEqual(['', '4.9 ml/s, 12 ml lost', 'bursts at 750 mmHg']);
    expect(figuresOf({ ...WHOLE, shedM3: 2.34e-6 })).toBe('2.3 ml lost');
  });
});

describe('what the page says of vessels', () => {
  const said = (watch: VesselWatch, vessels: readonly VesselState[], nowS: number): string[] => watch.take(vessels, nowS).map(({ words, figures }) => `${words} ${figures}`);

  it('is a warning as long as one bleeds, from the start on', () => {
    const watch = new VesselWatch(NEWS_S);
    expect(watch.take([BLEEDING], 0)).toEqual([{ key: 'bleeding', warns: true, words: 'artery bleeds:', figures: '4.9 ml/s, 12 ml lost' }]);
    expect(said(watch, [BLEEDING], 100)).toEqual(['artery bleeds: 4.9 ml/s, 12 ml lost']);
    expect(said(watch, [{ ...BLEEDING, bleeds: false }], 101)).toEqual(['artery no longer bleeds: 12 ml lost']);
    expect(said(watch, [{ ...BLEEDING, bleeds: false }], 102)).toEqual([]);
  });

  it('is one warning for all that bleed', () => {
    const vein = { ...BLEEDING, name: 'vein', bleedingM3S: 1e-6, shedM3: 1e-6 };
    expect(said(new VesselWatch(NEWS_S), [BLEEDING, vein, SEALED], 0)).toEqual(['artery, vein bleed: 5.9 ml/s, 13 ml lost']);
  });

  it('is for some seconds that a vessel is sealed, which it was not before', () => {
    const watch = new VesselWatch(NEWS_S);
    expect(said(watch, [SEALED], 0)).toEqual([]);
    watch.clear();
    expect(said(watch, [WHOLE], 1)).toEqual([]);
    expect(said(watch, [{ ...SEALED, burstPa: 12e3 }], 2)).toEqual(['artery is sealed: bursts at 90 mmHg']);
    expect(said(watch, [SEALED], 7.9)).toEqual(['artery is sealed: bursts at 750 mmHg']);
    expect(said(watch, [SEALED], 8)).toEqual([]);
  });
});
