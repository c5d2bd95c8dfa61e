// SPDX-License-Identifier: GPL-3.0-or-later
// Blood vessels in words and in the units of an operating room: millilitres and millimetres of mercury.
import { text } from '../text/text';
import type { VesselState } from '../wire/vessels';

const ML_PER_M3 = 1e6;
const PA_PER_MMHG = 133.322;
const WHOLE_ML = 10; // from this volume on, tenths of a millilitre are not shown

const rate = (bleedingM3S: number): string => `${(ML_PER_M3 * bleedingM3S).toFixed(1)} ml/s`;
const lost = (shedM3: number): string => {
  const ml = ML_PER_M3 * shedM3;
  return text.vesselWords.lost(ml.toFixed(ml < WHOLE_ML ? 1 : 0));
};
const bursts = (burstPa: number): string => text.vesselWords.bursts(Math.round(burstPa / PA_PER_MMHG));
const sum = (numbers: readonly number[]): number => numbers.reduce((total, number) => total + number, 0);

/** "parted, bleeding", "pressed shut", "open". A parted vessel usually also has holes beside the gap. */
export function stateWords({ parted, pierced, shut, sealed, bleeds }: VesselState): string {
  const say = text.vesselWords;
  const words = [parted ? say.parted : pierced ? say.pierced : '', sealed ? say.sealed : '', shut ? say.shut : '', bleeds ? say.bleeding : ''];
  return words.filter((word) => word !== '').join(', ') || say.open;
}

/** "4.9 ml/s, 12 ml lost, bursts at 750 mmHg"; zero values are left out. */
export function figuresOf({ bleeds, bleedingM3S, shedM3, burstPa }: VesselState): string {
  return [bleeds ? rate(bleedingM3S) : '', shedM3 > 0 ? lost(shedM3) : '', burstPa > 0 ? bursts(burstPa) : ''].filter((words) => words !== '').join(', ');
}

/** A message of the page: `words`, and `figures` that change. */
export interface Finding {
  /** key of a message that stays while the state lasts; null: a message that is shown once */
  key: string | null;
  warns: boolean;
  words: string;
  figures: string;
}

/** Returns one warning for all bleeding vessels, with the sums of their figures. */
function bleeding(vessels: readonly VesselState[]): Finding[] {
  if (vessels.length === 0) return [];
  const names = vessels.map(({ name }) => name).join(', ');
  const figures = `${rate(sum(vessels.map(({ bleedingM3S }) => bleedingM3S)))}, ${lost(sum(vessels.map(({ shedM3 }) => shedM3)))}`;
  return [{ key: 'bleeding', warns: true, words: text.vesselWords.bleeds(names, vessels.length), figures }];
}

/** Watches the vessels of a session and finds messages about them. */
export class VesselWatch {
  private before = new Map<string, VesselState>();
  /** time at which a seal began to hold, s of the page */
  private readonly sealedS = new Map<string, number>();

  /** newsS: how long the page shows that a vessel was sealed */
  constructor(private readonly newsS: number) {}

  /** Returns the messages at a time of the page. A bleeding vessel is reported from the start. A seal, or the end of a
   * bleeding, is reported only after a change. */
  take(vessels: readonly VesselState[], nowS: number): Finding[] {
    const found = [...bleeding(vessels.filter(({ bleeds }) => bleeds)), ...vessels.flatMap((vessel) => this.news(vessel, nowS))];
    this.before = new Map(vessels.map((vessel) => [vessel.name, vessel]));
    return found;
  }

  clear(): void {
    this.before.clear();
    this.sealedS.clear();
  }

  private news({ name, sealed, bleeds, shedM3, burstPa }: VesselState, nowS: number): Finding[] {
    const before = this.before.get(name);
    if (sealed && before && !before.sealed) this.sealedS.set(name, nowS);
    if (!sealed) this.sealedS.delete(name);
    const found: Finding[] = [];
    if (before?.bleeds && !bleeds) found.push({ key: null, warns: false, words: text.vesselWords.bleedsNoLonger(name), figures: lost(shedM3) });
    const since = nowS - (this.sealedS.get(name) ?? -Infinity);
    if (since < this.newsS) found.push({ key: `${name} sealed`, warns: false, words: text.vesselWords.isSealed(name), figures: bursts(burstPa) });
    return found;
  }
}
