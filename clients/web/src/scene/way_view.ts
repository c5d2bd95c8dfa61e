// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the path that the hand has drawn ahead of the tool, as dots. The dots disappear when the tool passes them, or when
// the rest of the path is dropped.
import { BufferAttribute, BufferGeometry, Points, PointsMaterial, type Vector3 } from 'three';

const DOTS_MAX = 400;
const DOT_PX = 4;
const SPACING_M = 0.002; // distance of dots where the hand was fast

export class WayView {
  readonly points: Points<BufferGeometry, PointsMaterial>;
  private shown = 0;

  constructor() {
    const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(3 * DOTS_MAX), 3));
    const material = new PointsMaterial({ size: DOT_PX, sizeAttenuation: false, color: 0xffb060, depthTest: false, transparent: true }); // after tissue that is translucent
    this.points = new Points(geometry, material);
    this.points.frustumCulled = false;
    this.points.renderOrder = 4;
    this.points.visible = false;
  }

  /** Shows a path. Returns whether the picture changed. */
  show(way: readonly Vector3[]): boolean {
    if (way.length === 0 && this.shown === 0) return false;
    const position = this.points.geometry.getAttribute('position') as BufferAttribute;
    let count = 0;
    for (let i = 1; i < way.length; i++) {
      const [from, to] = [way[i - 1], way[i]];
      const dots = Math.max(Math.round(from.distanceTo(to) / SPACING_M), 1);
      for (let k = 1; k <= dots && count < DOTS_MAX; k++) {
        const { x, y, z } = from.clone().lerp(to, k / dots);
        position.setXYZ(count++, x, y, z);
      }
    }
    this.shown = count;
    this.points.visible = count > 0; // one point of a way is where the tool is
    position.needsUpdate = true;
    this.points.geometry.setDrawRange(0, count);
    return true;
  }
}
