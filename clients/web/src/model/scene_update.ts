// SPDX-License-Identifier: GPL-3.0-or-later
// What is seen as foxglove.SceneUpdate: the tissue's present faces as triangles, a list for each layer, and
// each tool as a shaft with a tip, which glows where energy is on. `cautery record --mcap` writes the same
// (clients/cautery/scene_update.c).
import type { Color, CylinderPrimitive, Pose, SceneEntity, SceneEntityDeletionType, SceneUpdate, SpherePrimitive, Time, TriangleListPrimitive } from '@foxglove/schemas';

import type { ToolState } from '../wire/records';

/** The present faces of a layer: lists with three vertices for each face. */
export interface LayerFaces {
  layer: string;
  lists: Uint32Array[];
}

/** The state of a session at one moment, as the page shows it. */
export interface SeenMoment {
  /** ns since 1970 */
  timeNs: bigint;
  tick: number;
  /** simulated time, s */
  timeS: number;
  /** m (vertices x 3) */
  position: Float32Array;
  layers: LayerFaces[];
  tools: Pick<ToolState, 'name' | 'positionM' | 'rotation' | 'energized'>[];
}

const DELETE_ALL = 1 as unknown as SceneEntityDeletionType.ALL; // only types of that package are used
const METRES = 1e7; // coordinates are rounded to a tenth of a micrometre
// Sizes of a drawn instrument, m
const SHAFT_M = 0.06, SHAFT_DIAMETER_M = 0.002, TIP_DIAMETER_M = 0.0015;

const color = (r: number, g: number, b: number): Color => ({ r, g, b, a: 1 });
/** Colours of layers: pearly fascia, a pink membrane, fat; further layers have the last colour. */
const LAYER_COLORS = [color(0.9, 0.82, 0.76), color(0.85, 0.58, 0.5), color(0.93, 0.77, 0.4), color(0.7, 0.35, 0.32)];
const STEEL = color(0.7, 0.72, 0.75);
const GLOWING = color(1, 0.35, 0.1);
const AT_ORIGIN: Pose = { position: { x: 0, y: 0, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } };

const rounded = (metres: number): number => Math.round(metres * METRES) / METRES;

function trianglesOf(position: Float32Array, lists: readonly Uint32Array[], shade: Color): TriangleListPrimitive {
  const place = new Int32Array(position.length / 3).fill(-1);
  const points: TriangleListPrimitive['points'] = [];
  const indices: number[] = [];
  for (const list of lists) {
    for (const vertex of list) {
      if (place[vertex] < 0) {
        place[vertex] = points.length;
        points.push({ x: rounded(position[3 * vertex]), y: rounded(position[3 * vertex + 1]), z: rounded(position[3 * vertex + 2]) });
      }
      indices.push(place[vertex]);
    }
  }
  return { pose: AT_ORIGIN, points, color: shade, colors: [], indices };
}

/** Returns the pose of a point on the axis of the shaft, the third axis of the tool. */
function poseOf({ positionM: p, rotation: [w, x, y, z] }: SeenMoment['tools'][number], alongM: number): Pose {
  const axis = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];
  return {
    position: { x: rounded(p[0] + alongM * axis[0]), y: rounded(p[1] + alongM * axis[1]), z: rounded(p[2] + alongM * axis[2]) },
    orientation: { x, y, z, w },
  };
}

function tipOf(tool: SeenMoment['tools'][number]): SpherePrimitive {
  const size = { x: TIP_DIAMETER_M, y: TIP_DIAMETER_M, z: TIP_DIAMETER_M };
  return { pose: poseOf(tool, 0), size, color: tool.energized ? GLOWING : STEEL };
}

function shaftOf(tool: SeenMoment['tools'][number]): CylinderPrimitive {
  const size = { x: SHAFT_DIAMETER_M, y: SHAFT_DIAMETER_M, z: SHAFT_M };
  return { pose: poseOf(tool, (TIP_DIAMETER_M + SHAFT_M) / 2), size, bottom_scale: 1, top_scale: 1, color: STEEL };
}

export function sceneUpdate(moment: SeenMoment): SceneUpdate {
  const timestamp: Time = { sec: Number(moment.timeNs / 1_000_000_000n), nsec: Number(moment.timeNs % 1_000_000_000n) };
  const entity = (id: string, shapes: Partial<SceneEntity>): SceneEntity => ({
    timestamp,
    frame_id: 'session',
    id,
    lifetime: { sec: 0, nsec: 0 },
    frame_locked: false,
    metadata: [{ key: 'tick', value: String(moment.tick) }, { key: 'time_s', value: String(moment.timeS) }],
    arrows: [], cubes: [], spheres: [], cylinders: [], lines: [], triangles: [], texts: [], models: [],
    ...shapes,
  });
  const triangles = moment.layers.map(({ lists }, i) => trianglesOf(moment.position, lists, LAYER_COLORS[Math.min(i, LAYER_COLORS.length - 1)]));
  return {
    // Each update has the whole scene, so that a reader can begin in the middle.
    deletions: [{ timestamp, type: DELETE_ALL, id: '' }],
    entities: [
      entity('tissue', { triangles }),
      ...moment.tools.map((tool) => entity(`tool ${tool.name}`, { spheres: [tipOf(tool)], cylinders: [shaftOf(tool)] })),
    ],
  };
}
