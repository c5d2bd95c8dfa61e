// SPDX-License-Identifier: GPL-3.0-or-later
// What the camera's home shows: each tool's tip with a part of its shaft, and the tissue: all of it, or in a round picture
// the middles of its sides, so that it reaches the picture's edge.
import { Vector3 } from 'three';

import type { Extent } from '../model/field_shape';
import type { ToolState } from '../wire/records';

const SHAFT_SHOWN = 0.12; // shown length of a shaft, as a share of the diagonal of the tissue

export function framedPoints({ least, most }: Extent, tools: readonly ToolState[], round: boolean): Vector3[] {
  const [min, max] = [new Vector3(...least), new Vector3(...most)];
  const middle = min.clone().add(max).multiplyScalar(0.5);
  const reach = max.distanceTo(min);
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(
    (i) => new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z),
  );
  const tips = tools
    .map(({ positionM }) => new Vector3(...positionM))
    .filter((tip) => tip.distanceTo(middle) < reach) // a tool far away would make the tissue small
    .flatMap((tip) => [tip, tip.clone().setZ(tip.z + SHAFT_SHOWN * reach)]);
  const sides = [[min.x, middle.y], [max.x, middle.y], [middle.x, min.y], [middle.x, max.y]].map(([x, y]) => new Vector3(x, y, max.z));
  return [...(round ? sides : corners), ...tips];
}
