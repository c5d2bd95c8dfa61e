// SPDX-License-Identifier: GPL-3.0-or-later
// Where light comes from: beside an endoscope's lens, from where it falls off with distance; or, in the open view and where
// colours stand for a number, from a lamp beside the camera and above it.
import type { Orbit } from './orbit';
import type { SharedUniforms } from './tissue_view';

/** Offset of the lamp to the right of the camera and above it, over the distance to the target. */
const BESIDE = [-0.55, 0.75] as const;
const AT_LENS = [-0.05, 0.07] as const;
/** Ambient light; very little in a closed body. */
const AROUND = { lens: 0.16, dark: 0.4, light: 0.52 } as const;

export function placeLamp(shared: SharedUniforms, orbit: Orbit, trocar: boolean, dark: boolean): void {
  const { camera, target } = orbit;
  const { x, y } = orbit.axes();
  const distance = camera.position.distanceTo(target);
  const atLens = trocar && shared.mapChannel.value < 0;
  const [aside, above] = atLens ? AT_LENS : BESIDE;
  shared.light.value.copy(camera.position).addScaledVector(x, aside * distance).addScaledVector(y, above * distance);
  shared.scope.value.set(Number(atLens), distance);
  shared.ambient.value = atLens ? AROUND.lens : dark ? AROUND.dark : AROUND.light;
}
