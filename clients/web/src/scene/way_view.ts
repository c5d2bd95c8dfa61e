// SPDX-License-Identifier: GPL-3.0-or-later
// The way that a hand has drawn ahead of its tool: dots that the tool will pass, or that go when the rest
// of the way is dropped.
import { BufferAttribute, BufferGeometry, Points, PointsMaterial, type Vector3 } from 'three';

const DOTS_MAX = 400;
const DOT_PX = 4;

export class WayView {
  readonly points: Points<BufferGeometry, PointsMaterial>;
  private shown = 0;

  constructor() {
    const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(3 * DOTS_MAX), 3));
    const material = new PointsMaterial({ size: DOT_PX, sizeAttenuation: false, color: 0xffb060, depthTest: false });
    this.points = new Points(geometry, material);
    this.points.frustumCulled = false;
    this.points.renderOrder = 4;
    this.points.visible = false;
  }

  /** Says whether the picture is another than before. */
  show(way: readonly Vector3[]): boolean {
    const count = Math.min(way.length, DOTS_MAX);
    if (count === 0 && this.shown === 0) return false;
    this.shown = count;
    this.points.visible = count > 1; // one point is where the tool is
    const position = this.points.geometry.getAttribute('position') as BufferAttribute;
    for (let i = 0; i < count; i++) position.setXYZ(i, way[i].x, way[i].y, way[i].z);
    position.needsUpdate = true;
    this.points.geometry.setDrawRange(0, count);
    return true;
  }
}
