// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke as puffs that rise where tissue is heated, drift with slow air, spread, and disappear after some seconds. Removed
// elements cause more puffs. This is decoration: no channel has the amount of smoke yet.

export const PUFFS = 128;
const LIFE_S = 3.2; // life of a mean puff: as long as a wisp is visible in still air
const HEATING_PER_S = 7; // puffs in a second while a hot tip touches tissue
const PER_FACE = 0.6; // puffs for each face that is removed
const OWED_MOST = 12; // largest number of waiting puffs, so that a burst does not hide the tissue
const RISE_M_S = 0.016;
const DRIFT_M_S = 0.007;
const SWIRL_PER_M = 55; // waves of the air: some 10 cm long
const SWIRL_PER_S = 0.35;

/** Returns the sideways velocity of the air, m/s; slow, and different from point to point. */
function drift(x: number, y: number, z: number, seconds: number): [number, number] {
  const turn = SWIRL_PER_S * seconds;
  return [
    DRIFT_M_S * (0.8 + Math.sin(SWIRL_PER_M * (y + 0.7 * z) + 3 * turn)),
    DRIFT_M_S * Math.sin(SWIRL_PER_M * (x - 0.6 * z) + 2 * turn + 1),
  ];
}

export class Puffs {
  /** m (puffs x 3) */
  readonly position = new Float32Array(3 * PUFFS);
  /** 0 new to 1 gone */
  readonly age = new Float32Array(PUFFS).fill(1);
  /** random number of each puff, 0 to 1 */
  readonly seed: Float32Array;
  private next = 0;
  private owed = 0;
  private seconds = 0;

  constructor(random: () => number = Math.random) {
    this.seed = Float32Array.from({ length: PUFFS }, random);
  }

  /** Number of puffs in the air. */
  get count(): number {
    return this.age.reduce((sum, age) => sum + Number(age < 1), 0);
  }

  /** Notes removed faces, after which the next puffs come sooner. */
  burst(faces: number): void {
    this.owed = Math.min(this.owed + PER_FACE * faces, OWED_MOST);
  }

  /** Moves the puffs, and starts new ones at the sources, m. Returns true while any puff is in the air. */
  advance(seconds: number, sources: readonly (readonly [number, number, number])[]): boolean {
    this.seconds += seconds;
    let alive = false;
    for (let i = 0; i < PUFFS; i++) {
      if (this.age[i] >= 1) continue;
      this.move(i, seconds);
      alive = true;
    }
    this.owed = sources.length > 0 ? Math.min(this.owed + HEATING_PER_S * seconds, OWED_MOST) : 0;
    for (; this.owed >= 1; this.owed--) {
      this.position.set(sources[this.next % sources.length], 3 * this.next);
      this.age[this.next] = 0;
      this.next = (this.next + 1) % PUFFS;
      alive = true;
    }
    return alive;
  }

  private move(i: number, seconds: number): void {
    const at = 3 * i;
    const [x, y, z] = this.position.subarray(at, at + 3);
    const [dx, dy] = drift(x, y, z, this.seconds);
    const age = this.age[i];
    this.position[at] = x + dx * seconds * (0.3 + age);
    this.position[at + 1] = y + dy * seconds * (0.3 + age);
    this.position[at + 2] = z + RISE_M_S * seconds * (1.2 - 0.7 * age) * (0.7 + 0.6 * this.seed[i]);
    this.age[i] = Math.min(age + seconds / (LIFE_S * (0.7 + 0.6 * this.seed[i])), 1);
  }
}
