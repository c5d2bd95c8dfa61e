// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the mesh of a blood vessel: a tube along the points of its middle line, in several pieces if it is parted. Each
// piece has ends that show the lumen. The tube is slimmer where the lumen is pressed shut.
import { POINT_NUMBERS } from '../wire/vessels';

export interface Tube {
  position: Float32Array;
  normal: Float32Array;
  /** two numbers a vertex: the share of the lumen that is open, and 1 where the lumen is seen from its end, 0 on the wall */
  look: Float32Array;
  index: Uint32Array;
}

type Vector = readonly [number, number, number];

const SIDES = 12; // a corner is 3 % of the radius from the circle
const SHUT_RADIUS = 0.6; // radius of a shut tube over the open radius; two walls lie on each other
const LUMEN = 0.75; // radius of the lumen over the outer radius; frames do not have the thickness of the wall

const minus = (a: Vector, b: Vector): Vector => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a: Vector, b: Vector): Vector => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const along = (a: Vector, by: number, b: Vector): Vector => [a[0] + by * b[0], a[1] + by * b[1], a[2] + by * b[2]];
const unit = (a: Vector, otherwise: Vector): Vector => {
  const length = Math.hypot(...a);
  return length > 0 ? [a[0] / length, a[1] / length, a[2] / length] : otherwise;
};

class Builder {
  readonly position: number[] = [];
  readonly normal: number[] = [];
  readonly look: number[] = [];
  readonly index: number[] = [];

  get count(): number {
    return this.position.length / 3;
  }

  add(at: Vector, normal: Vector, open: number, lumen: number): void {
    this.position.push(...at);
    this.normal.push(...normal);
    this.look.push(open, lumen);
  }

  /** Adds the faces between a ring of vertices and the next; `outwards` decides their front side. */
  join(from: number, to: number, outwards: boolean): void {
    for (let s = 0; s < SIDES; s++) {
      const [a, b] = outwards ? [s, (s + 1) % SIDES] : [(s + 1) % SIDES, s];
      this.index.push(from + a, from + b, to + b, from + a, to + b, to + a);
    }
  }
}

interface Ring {
  at: Vector;
  tangent: Vector;
  /** unit vectors from the middle to the corners */
  spokes: Vector[];
  radius: number;
  open: number;
}

/** Returns the rings around the points of a piece. Each ring is twisted as little as possible against the previous ring. */
function ringsOf(points: Float32Array, first: number, end: number, radiusM: number): Ring[] {
  const at = (i: number): Vector => [points[POINT_NUMBERS * i], points[POINT_NUMBERS * i + 1], points[POINT_NUMBERS * i + 2]];
  const rings: Ring[] = [];
  let side: Vector = [0, 0, 0];
  let tangent: Vector = [1, 0, 0];
  for (let i = first; i < end; i++) {
    tangent = unit(minus(at(Math.min(i + 1, end - 1)), at(Math.max(i - 1, first))), tangent);
    const steep: Vector = Math.abs(tangent[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
    const before = i === first ? steep : side;
    side = unit(along(before, -dot(before, tangent), tangent), steep);
    const other = cross(tangent, side);
    const open = Math.min(points[POINT_NUMBERS * i + 3], 1);
    const spokes = Array.from({ length: SIDES }, (_, s) => {
      const angle = (2 * Math.PI * s) / SIDES;
      return along([side[0] * Math.cos(angle), side[1] * Math.cos(angle), side[2] * Math.cos(angle)], Math.sin(angle), other);
    });
    rings.push({ at: at(i), tangent, spokes, open, radius: radiusM * (SHUT_RADIUS + (1 - SHUT_RADIUS) * Math.sqrt(open)) });
  }
  return rings;
}

/** Adds the end of a piece: its wall as a rim, and the lumen inside. */
function addEnd(made: Builder, { at, tangent, spokes, open, radius }: Ring, last: boolean): void {
  const normal = along([0, 0, 0], last ? 1 : -1, tangent);
  const first = made.count;
  for (const [share, lumen] of [[1, 0], [LUMEN, 1], [0, 1]] as const)
    for (const spoke of spokes) made.add(along(at, share * radius, spoke), normal, open, lumen);
  made.join(first, first + SIDES, last);
  made.join(first + SIDES, first + 2 * SIDES, last);
}

function addPiece(made: Builder, rings: readonly Ring[]): void {
  rings.forEach(({ at, spokes, radius, open }, i) => {
    const first = made.count;
    for (const spoke of spokes) made.add(along(at, radius, spoke), spoke, open, 0);
    if (i > 0) made.join(first - SIDES, first, true);
  });
  addEnd(made, rings[0], false);
  addEnd(made, rings[rings.length - 1], true);
}

/** `points` as in VesselState. A single point between two gaps has no length and is not drawn. */
export function makeTube(points: Float32Array, radiusM: number): Tube {
  const made = new Builder();
  const count = points.length / POINT_NUMBERS;
  for (let first = 0; first < count; first++) {
    let end = first;
    while (end < count && points[POINT_NUMBERS * end + 3] >= 0) end++;
    if (end - first > 1) addPiece(made, ringsOf(points, first, end, radiusM));
    first = end;
  }
  return {
    position: Float32Array.from(made.position),
    normal: Float32Array.from(made.normal),
    look: Float32Array.from(made.look),
    index: Uint32Array.from(made.index),
  };
}
