// SPDX-License-Identifier: GPL-3.0-or-later
// The way that the hand has shown and the tool has not gone yet. A cut keeps all of it, so that a hand
// that is quicker than the tool leaves no gaps; without heat only where the hand is now counts.
import { Vector3 } from 'three';

const SPACING_M = 0.0005; // of kept points: a cut is some millimetres wide
const POINTS_MAX = 400; // 200 mm: longer than any tissue here; beyond it the way's end is drawn in

export class Way {
  private readonly points: Vector3[] = [];

  /** Goes straight to a point; what was left of the way is dropped. */
  to(point: Vector3): void {
    this.points.length = 0;
    this.points.push(point.clone());
  }

  /** Goes on to a point after what is left. */
  append(point: Vector3): void {
    const { points } = this;
    const end = points.at(-1);
    if (end && (points.length >= POINTS_MAX || end.distanceTo(point) < SPACING_M)) end.copy(point);
    else points.push(point.clone());
  }

  clear(): void {
    this.points.length = 0;
  }

  get empty(): boolean {
    return this.points.length === 0;
  }

  /** Moves `from` along by at most some metres; returns what of them was not needed. */
  follow(from: Vector3, metres: number): number {
    const { points } = this;
    let left = metres;
    while (points.length > 0 && left > 0) {
      const distance = from.distanceTo(points[0]);
      if (distance > left) {
        from.addScaledVector(points[0].clone().sub(from), left / distance);
        return 0;
      }
      from.copy(points[0]);
      points.shift();
      left -= distance;
    }
    return left;
  }

  /** What is left, from the tool on. */
  rest(): readonly Vector3[] {
    return this.points;
  }
}
