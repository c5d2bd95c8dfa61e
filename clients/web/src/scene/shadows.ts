// SPDX-License-Identifier: GPL-3.0-or-later
// What instruments do to the light on the tissue: shafts and tips cast shadow, hot tips glow, and a ring
// under each tip tells how high it is.
import { Vector3 } from 'three';

import { toolSizes } from '../model/tool_parts';
import type { ToolState } from '../wire/records';
import { CAPSULES_MAX, FAR_AWAY, GLOWS_MAX, type SharedUniforms } from './tissue_view';
import type { ToolView } from './tool_view';

const GLOW = 0.12; // of a tip at its hottest

export function placeShadows(
  shared: SharedUniforms,
  states: readonly ToolState[],
  tools: ReadonlyMap<string, ToolView>,
  heatOf: (state: ToolState) => number,
): void {
  const { capsuleFrom, capsuleTo, capsuleCount, glow, tips } = shared;
  let capsules = 0;
  let glows = 0;
  let rings = 0;
  for (const light of [...glow.value, ...tips.value]) light.w = 0;
  for (const state of states) {
    const view = tools.get(state.name);
    if (!view || capsules + 2 > CAPSULES_MAX) continue;
    view.group.updateMatrixWorld();
    const matrix = view.group.matrixWorld;
    const { hot, tip, shaft, shaftLength } = toolSizes(view.definition);
    const add = (from: Vector3, to: Vector3, radius: number): void => {
      from.applyMatrix4(matrix);
      capsuleFrom.value[capsules].set(from.x, from.y, from.z, radius);
      capsuleTo.value[capsules++].copy(to.applyMatrix4(matrix));
    };
    add(new Vector3(0, 0, 2.2 * tip), new Vector3(0, 0, shaftLength), shaft);
    const half = view.definition.shape === 'hook' ? tip / 2 : 0;
    add(new Vector3(-half, 0, 0), half > 0 ? new Vector3(half, 0, 0) : new Vector3(0, 0, tip), hot);
    const { x, y, z } = view.group.position;
    if (rings < GLOWS_MAX) tips.value[rings++].set(x, y, z, hot);
    const heat = heatOf(state);
    if (heat > 0 && glows < GLOWS_MAX) {
      glow.value[glows++].set(x, y, z, GLOW * heat);
    }
  }
  if (capsules === 0) {
    capsuleFrom.value[0].set(...FAR_AWAY, 0); // the shader reads the first one always
    capsuleTo.value[0].set(...FAR_AWAY);
  }
  capsuleCount.value = capsules;
}
