// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that looks at a point and turns around it; z is up. Its first view (home) shows everything that was framed, for
// any shape of the picture.
import { PerspectiveCamera, Vector3 } from 'three';

const FIELD_OF_VIEW = 38; // degrees, over the height of the picture
const HOME_ELEVATION = 0.85; // rad
const STEEPEST = 1.5; // rad above or below the horizon
const NEAREST_M = 0.01;
const FARTHEST_M = 5;
/** Share of the picture, on each side of its middle, that the framed points may fill. */
const FREE = { side: 0.94, top: 0.92, bottom: 0.94 };
const FITTING_STEPS = 24;

export interface CameraPose {
  azimuth: number;
  elevation: number;
  distance: number;
  target: readonly [number, number, number];
}

export class Orbit {
  readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.001, 10);
  readonly target = new Vector3();
  private azimuth = -Math.PI / 2;
  private elevation = HOME_ELEVATION;
  private distance = 0.25;
  private framed: readonly Vector3[] = [];
  /** whether the camera has not been moved since its first view */
  private atHome = true;
  /** share of the height of the picture that buttons cover at its foot */
  private covered = 0;
  /** radius of the round picture for the framed points, over half the height of the picture; null: the picture is not round */
  private circle: number | null = null;

  constructor() {
    this.camera.up.set(0, 0, 1);
    this.place();
  }

  /** Looks at all given points, from the side of the surgeon. */
  frame(points: readonly Vector3[]): void {
    this.framed = points;
    this.reset();
  }

  reset(): void {
    this.atHome = true;
    this.azimuth = -Math.PI / 2;
    this.elevation = HOME_ELEVATION;
    this.fit();
  }

  /** Returns the pose of the camera; null: the first view. */
  get pose(): CameraPose | null {
    return this.atHome ? null : this.here;
  }

  get here(): CameraPose {
    const { azimuth, elevation, distance, target } = this;
    return { azimuth, elevation, distance, target: target.toArray() };
  }

  /** Sets the pose of a link or a saved view. */
  restore({ azimuth, elevation, distance, target }: CameraPose): void {
    this.azimuth = azimuth;
    this.distance = Math.min(Math.max(distance, NEAREST_M), FARTHEST_M);
    this.target.fromArray([...target]);
    this.turn(0, elevation - this.elevation);
  }

  /** Looks from a side: at azimuth 0 from the surgeon's side, counted to the right, rad. */
  look(elevation: number, azimuth = 0): void {
    this.azimuth = azimuth - Math.PI / 2;
    this.elevation = Math.min(Math.max(elevation, -STEEPEST), STEEPEST);
    this.fit();
    this.atHome = false;
  }

  turn(byAzimuth: number, byElevation: number): void {
    this.atHome = false;
    this.azimuth += byAzimuth;
    this.elevation = Math.min(Math.max(this.elevation + byElevation, -STEEPEST), STEEPEST);
    this.place();
  }

  zoom(factor: number): void {
    this.atHome = false;
    this.distance = Math.min(Math.max(this.distance * factor, NEAREST_M), FARTHEST_M);
    this.place();
  }

  /** Moves the target by a share of the picture's height. */
  pan(right: number, up: number): void {
    this.atHome = false;
    const height = 2 * this.distance * Math.tan((this.camera.fov * Math.PI) / 360);
    const { x, y } = this.axes();
    this.target.addScaledVector(x, -right * height).addScaledVector(y, -up * height);
    this.place();
  }

  /** Returns the directions right, up, and towards the eye, in the world. */
  axes(): { x: Vector3; y: Vector3; z: Vector3 } {
    const [x, y, z] = [new Vector3(), new Vector3(), new Vector3()];
    this.camera.matrixWorld.extractBasis(x, y, z);
    return { x, y, z };
  }

  /** Returns the ray from the eye through a point of the picture, both coordinates from -1 to 1. */
  ray(x: number, y: number): { origin: Vector3; direction: Vector3 } {
    const origin = new Vector3().setFromMatrixPosition(this.camera.matrixWorld);
    return { origin, direction: new Vector3(x, y, 0.5).unproject(this.camera).sub(origin).normalize() };
  }

  /** Returns the position of a point in the picture, both coordinates from -1 to 1. */
  picturePlace(point: Vector3): { x: number; y: number } {
    const { x, y } = point.clone().project(this.camera);
    return { x, y };
  }

  resize(width: number, height: number, coveredBelow: number, circle: number | null): void {
    this.circle = circle;
    this.covered = Math.min(coveredBelow / Math.max(height, 1), 0.5);
    this.camera.aspect = width / Math.max(height, 1);
    this.camera.updateProjectionMatrix();
    if (this.atHome) this.fit();
  }

  /** Sets distance and height of the target so that the framed points fill the free part of the picture. */
  private fit(): void {
    if (this.framed.length === 0) {
      this.place();
      return;
    }
    this.target.set(0, 0, 0);
    for (const point of this.framed) this.target.addScaledVector(point, 1 / this.framed.length);
    const round = FREE.side * (this.circle ?? Infinity);
    const side = Math.min(FREE.side, round / this.camera.aspect);
    const top = Math.min(FREE.top, round);
    const bottom = Math.min(FREE.bottom - 2 * this.covered, round);
    for (let i = 0; i < FITTING_STEPS; i++) {
      this.place();
      const seen = this.framed.map((point) => this.picturePlace(point));
      const [left, right] = [Math.min(...seen.map(({ x }) => x)), Math.max(...seen.map(({ x }) => x))];
      const [low, high] = [Math.min(...seen.map(({ y }) => y)), Math.max(...seen.map(({ y }) => y))];
      const out = Math.max(...seen.map(({ x, y }) => Math.hypot(x * this.camera.aspect, y)));
      const share = Math.max((right - left) / (2 * side), (high - low) / (top + bottom), out / round);
      const half = this.distance * Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
      const { x, y } = this.axes();
      this.target.addScaledVector(x, ((left + right) / 2) * half * this.camera.aspect);
      this.target.addScaledVector(y, ((low + high - top + bottom) / 2) * half);
      this.distance = Math.min(Math.max(this.distance * share, 2 * NEAREST_M), FARTHEST_M);
    }
    this.place();
  }

  private place(): void {
    const flat = Math.cos(this.elevation) * this.distance;
    this.camera.position.set(
      this.target.x + flat * Math.cos(this.azimuth),
      this.target.y + flat * Math.sin(this.azimuth),
      this.target.z + Math.sin(this.elevation) * this.distance,
    );
    this.camera.near = this.distance / 50;
    this.camera.far = this.distance * 20 + 1;
    this.camera.updateProjectionMatrix();
    this.camera.lookAt(this.target);
    this.camera.updateMatrixWorld();
  }
}
