// SPDX-License-Identifier: GPL-3.0-or-later
// The path of the hand that the tool has not followed yet. A cut keeps the whole path, so that a hand which is faster
// than the tool leaves no gaps. Without heat, only the present position of the hand counts.
import { Vector3 } from 'three';

const SPACING_M = 0.0005; // distance of kept points; a cut is some millimetres wide
const POINTS_MAX = 400; // 200 mm, longer than any tissue; beyond this the last point of the path moves

export class Way {
  private readonly points: Vector3[] = [];

  /** Replaces the path by a straight line to a point. */
  to(point: Vector3): void {
    this.points.length = 0;
    this.points.push(point.clone());
  }

  /** Appends a point to the path. */
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

  /** Moves `from` along the path by at most `metres`; returns the metres that were not needed. */
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

  /** Returns the remaining path, from the tool on. */
  rest(): readonly Vector3[] {
    return this.points;
  }
}
