// SPDX-License-Identifier: GPL-3.0-or-later
// Writes session, tick and camera into the address of the page, so that a reloaded or shared page shows the same.
import type { Model } from '../model/model';
import type { CameraPose } from '../scene/orbit';
import type { Viewport } from '../scene/viewport';

const LOOK_MS = 100;
const WRITE_MS = 1000; // least time between two writes while tick or camera change; another session is written at once
const DEGREES = 180 / Math.PI;
const MM = 1000;

/** Azimuth and elevation in degrees, distance and target in millimetres. */
export function cameraText({ azimuth, elevation, distance, target }: CameraPose): string {
  return [azimuth * DEGREES, elevation * DEGREES, distance * MM, ...target.map((value) => value * MM)].map((value) => value.toFixed(1)).join(',');
}

export function readCamera(text: string | null): CameraPose | null {
  const numbers = (text ?? '').split(',').map(Number);
  if (text === null || numbers.length !== 6 || !numbers.every(Number.isFinite) || numbers[2] <= 0) return null;
  const [azimuth, elevation, distance, x, y, z] = numbers;
  return { azimuth: azimuth / DEGREES, elevation: elevation / DEGREES, distance: distance / MM, target: [x / MM, y / MM, z / MM] };
}

export interface Address {
  session: string | null;
  camera: CameraPose | null;
  /** a past moment that somebody has shared; null where the page was only loaded again */
  tick: number | null;
}

export function readAddress(): Address {
  const asked = new URLSearchParams(window.location.search);
  const [navigation] = performance.getEntriesByType('navigation') as PerformanceNavigationTiming[];
  const tick = Number(asked.get('tick') ?? NaN);
  return {
    session: asked.get('session'),
    camera: readCamera(asked.get('camera')),
    tick: navigation?.type !== 'reload' && Number.isInteger(tick) && tick >= 0 ? tick : null,
  };
}

/** Keeps the address true: what is looked at, at the tick that is looked at. */
export function keepAddress(model: Model, viewport: Viewport): void {
  let writtenAt = 0;
  setInterval(() => {
    if (!model.frame || model.session !== model.frame.session || document.hidden) return;
    const address = new URL(window.location.href);
    if (address.searchParams.get('session') === model.session && performance.now() - writtenAt < WRITE_MS) return;
    writtenAt = performance.now();
    address.searchParams.set('session', model.session);
    address.searchParams.set('tick', String(model.held ?? model.frame.tick));
    const { pose } = viewport.orbit;
    if (pose) address.searchParams.set('camera', cameraText(pose));
    else address.searchParams.delete('camera');
    address.search = address.search.replaceAll('%2C', ',');
    if (address.href !== window.location.href) window.history.replaceState(null, '', address.href);
  }, LOOK_MS);
}
