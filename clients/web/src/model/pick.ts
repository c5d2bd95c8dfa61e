// SPDX-License-Identifier: GPL-3.0-or-later
// Finds where a ray first meets the drawn tissue, on either side of faces (Moeller and Trumbore).

export interface Hit {
  distance: number;
  batch: number;
  /** the nearest corner of the triangle */
  vertex: number;
}

export function pick(
  origin: readonly [number, number, number],
  direction: readonly [number, number, number],
  position: Float32Array,
  indices: readonly (Uint32Array | null)[],
  /** whether the clip plane hides the point at a distance along the ray */
  away: (distance: number) => boolean = () => false,
): Hit | null {
  let best: Hit | null = null;
  let corner = 0;
  for (let batch = 0; batch < indices.length; batch++) {
    const index = indices[batch];
    if (!index) continue;
    for (let i = 0; i < index.length; i += 3) {
      const distance = meet(origin, direction, position, 3 * index[i], 3 * index[i + 1], 3 * index[i + 2]);
      if (distance <= 0 || (best && distance >= best.distance) || away(distance)) continue;
      best = { distance, batch, vertex: index[i] };
      corner = i;
    }
  }
  if (!best) return null;
  const corners = [...indices[best.batch]!.subarray(corner, corner + 3)];
  const squared = (v: number): number => [0, 1, 2].reduce((sum, c) => sum + (origin[c] + best.distance * direction[c] - position[3 * v + c]) ** 2, 0);
  const vertex = corners.reduce((nearest, v) => (squared(v) < squared(nearest) ? v : nearest));
  return { ...best, vertex };
}

const PARALLEL = 1e-18; // m^2: edges of a micrometre seen edge-on
/** Share of an edge by which triangles are enlarged, so that rounding (1e-12) lets no ray pass between two triangles. */
const SEAM = 1e-9;

function meet(
  o: readonly [number, number, number],
  d: readonly [number, number, number],
  p: Float32Array,
  a: number,
  b: number,
  c: number,
): number {
  const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
  const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
  const px = d[1] * vz - d[2] * vy, py = d[2] * vx - d[0] * vz, pz = d[0] * vy - d[1] * vx;
  const determinant = ux * px + uy * py + uz * pz;
  if (Math.abs(determinant) < PARALLEL) return -1;
  const sx = o[0] - p[a], sy = o[1] - p[a + 1], sz = o[2] - p[a + 2];
  const s = (sx * px + sy * py + sz * pz) / determinant;
  if (s < -SEAM || s > 1 + SEAM) return -1;
  const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
  const t = (d[0] * qx + d[1] * qy + d[2] * qz) / determinant;
  if (t < -SEAM || s + t > 1 + SEAM) return -1;
  return (vx * qx + vy * qy + vz * qz) / determinant;
}
