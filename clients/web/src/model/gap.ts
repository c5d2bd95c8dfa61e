// SPDX-License-Identifier: GPL-3.0-or-later
// Finds where a ray passes a gap in the drawn tissue: on the surface that continues the tissue around the gap.

type Vector = readonly [number, number, number];

/** Half of the widest gap that is bridged. */
const REACH_M = 0.02;
const SECTORS = 12;
/** Number of adjacent sectors without tissue that mean an edge of the tissue, not a gap: nearly half a turn. */
const OPEN_SECTORS = SECTORS / 2 - 1;
const NEAREST_M2 = 1e-8; // m^2, least squared distance, so that a vertex on the ray does not divide by zero
const GRAZING = 0.2; // cosine of the angle to the ray below which the surface gives no useful distance

const cross = (a: Vector, b: Vector): Vector => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

function normalised(v: Vector): Vector {
  const length = Math.hypot(...v);
  return [v[0] / length, v[1] / length, v[2] / length];
}

/** Weighted sums over vertices around the ray; the weight falls with the fourth power of the distance. */
class Around {
  private weight = 0;
  private readonly place: [number, number, number] = [0, 0, 0];
  private readonly normal: [number, number, number] = [0, 0, 0];
  private readonly seen = new Uint8Array(SECTORS);

  add(right: number, up: number, place: Vector, normal: Vector, side: number): void {
    const squared = right * right + up * up;
    const weight = 1 / (squared + NEAREST_M2) ** 2;
    this.weight += weight;
    for (let c = 0; c < 3; c++) {
      this.place[c] += weight * place[c];
      this.normal[c] += weight * side * normal[c];
    }
    this.seen[Math.min(Math.floor((Math.atan2(up, right) / (2 * Math.PI) + 0.5) * SECTORS), SECTORS - 1)] = 1;
  }

  get surrounds(): boolean {
    let open = 0;
    for (let i = 0; i < 2 * SECTORS; i++) {
      open = this.seen[i % SECTORS] ? 0 : open + 1;
      if (open >= OPEN_SECTORS) return false;
    }
    return true;
  }

  /** Returns the distance along the ray to the surface through the added vertices. */
  distance(origin: Vector, direction: Vector): number {
    const to: Vector = [0, 1, 2].map((c) => this.place[c] / this.weight - origin[c]) as [number, number, number];
    const facing = dot(this.normal, direction);
    return Math.abs(facing) < GRAZING * Math.hypot(...this.normal) ? dot(to, direction) : dot(to, this.normal) / facing;
  }
}

/**
 * Distance along a ray that meets no tissue, where tissue is all around it; null beside the tissue. What is
 * cut away from the picture is no tissue, and nothing goes on into it.
 */
export function acrossGap(
  origin: Vector,
  direction: Vector,
  position: Float32Array,
  normal: Float32Array,
  indices: readonly (Uint32Array | null)[],
  /** whether the clip plane hides a point */
  hidden: (x: number, y: number, z: number) => boolean = () => false,
): number | null {
  const right = normalised(cross(direction, Math.abs(direction[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  const up = cross(right, direction);
  const around = new Around();
  for (const index of indices) {
    for (const v of index ?? []) {
      const tx = position[3 * v] - origin[0], ty = position[3 * v + 1] - origin[1], tz = position[3 * v + 2] - origin[2];
      const x = tx * right[0] + ty * right[1] + tz * right[2];
      const y = tx * up[0] + ty * up[1] + tz * up[2];
      if (x * x + y * y > REACH_M * REACH_M || tx * direction[0] + ty * direction[1] + tz * direction[2] <= 0) continue;
      if (hidden(position[3 * v], position[3 * v + 1], position[3 * v + 2])) continue;
      const of: Vector = [normal[3 * v], normal[3 * v + 1], normal[3 * v + 2]];
      around.add(x, y, [position[3 * v], position[3 * v + 1], position[3 * v + 2]], of, dot(of, direction) > 0 ? -1 : 1);
    }
  }
  if (!around.surrounds) return null;
  const distance = around.distance(origin, direction);
  const [x, y, z] = [0, 1, 2].map((c) => origin[c] + distance * direction[c]);
  return hidden(x, y, z) ? null : distance;
}
