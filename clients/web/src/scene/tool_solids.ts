// SPDX-License-Identifier: GPL-3.0-or-later
// The solids of instruments as triangles. Their surfaces are the core's signed distances within a tenth of
// a millimetre, see tests/browser/unit/scene/tool_solids.test.ts.
import { BoxGeometry, BufferGeometry, CapsuleGeometry, Curve, Quaternion, SphereGeometry, TubeGeometry, Vector3 } from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

import type { ToolPart } from '../model/tool_parts';

/** Number of sides of round parts; they deviate by at most 0.01 of the radius. */
const AROUND = 28;
const RINGS = 8; // number of rings of a quarter
const EDGE = 4; // lines in each half of the rounding of a plate

class QuarterArc extends Curve<Vector3> {
  constructor(
    private readonly center: readonly [number, number, number],
    private readonly bend: number,
  ) {
    super();
  }

  override getPoint(t: number, target = new Vector3()): Vector3 {
    const angle = (Math.PI / 2) * t;
    const [x, y, z] = this.center;
    return target.set(x - this.bend * Math.sin(angle), y, z - this.bend * Math.cos(angle));
  }
}

const Y = new Vector3(0, 1, 0);

function capsule(part: ToolPart & { solid: 'capsule' }): BufferGeometry {
  const from = new Vector3(...part.from);
  const along = new Vector3(...part.to).sub(from);
  const length = along.length();
  const geometry = length > 0 ? new CapsuleGeometry(part.radius, length, RINGS, AROUND) : new SphereGeometry(part.radius, AROUND, 2 * RINGS);
  if (length > 0) geometry.applyQuaternion(new Quaternion().setFromUnitVectors(Y, along.clone().normalize()));
  return geometry.translate(from.x + along.x / 2, from.y + along.y / 2, from.z + along.z / 2);
}

/** Returns a rounded box: the grid of a cube with most of its lines in the rounding, moved onto the surface. */
function plate(part: ToolPart & { solid: 'plate' }): BufferGeometry {
  const [least, most] = [new Vector3(...part.least), new Vector3(...part.most)];
  const center = least.clone().add(most).multiplyScalar(0.5);
  const core = most.clone().sub(least).multiplyScalar(0.5).addScalar(-part.rounding).max(new Vector3());
  const lines = 2 * EDGE + 1;
  const geometry = new BoxGeometry(lines, lines, lines, lines, lines, lines);
  /** Returns the position of a line of the grid; lines of the rounding differ by equal angles. */
  const place = (line: number, flat: number): number => {
    const beyond = Math.max(Math.abs(line) - 0.5, 0) / EDGE;
    return Math.sign(line) * (flat + part.rounding * Math.tan((Math.PI / 4) * beyond));
  };
  const position = geometry.getAttribute('position');
  const normal = geometry.getAttribute('normal');
  const at = new Vector3();
  for (let i = 0; i < position.count; i++) {
    at.set(place(position.getX(i), core.x), place(position.getY(i), core.y), place(position.getZ(i), core.z));
    const inner = at.clone().clamp(core.clone().negate(), core);
    const out = at.clone().sub(inner).normalize();
    at.copy(inner).addScaledVector(out, part.rounding);
    position.setXYZ(i, at.x, at.y, at.z);
    normal.setXYZ(i, out.x, out.y, out.z);
  }
  return geometry.translate(center.x, center.y, center.z);
}

/** Returns a bent wire with round ends. */
function arc(part: ToolPart & { solid: 'arc' }): BufferGeometry {
  const curve = new QuarterArc(part.center, part.bend);
  const ends = [curve.getPoint(0), curve.getPoint(1)].map((end) =>
    new SphereGeometry(part.radius, AROUND, 2 * RINGS).translate(end.x, end.y, end.z),
  );
  return mergeGeometries([new TubeGeometry(curve, 2 * RINGS, part.radius, AROUND), ...ends]);
}

export function solidGeometry(part: ToolPart): BufferGeometry {
  switch (part.solid) {
    case 'capsule':
      return capsule(part);
    case 'plate':
      return plate(part);
    case 'arc':
      return arc(part);
  }
}
