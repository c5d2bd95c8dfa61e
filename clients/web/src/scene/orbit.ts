// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that looks at a point and turns around it; z is up.
import { Box3, PerspectiveCamera, Vector3 } from 'three';

const FIELD_OF_VIEW = 38; // degrees, of the shorter side
const HOME_ELEVATION = 0.85; // rad
const STEEPEST = 1.5; // rad above or below the horizon

export class Orbit {
  readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.001, 10);
  readonly target = new Vector3();
  private azimuth = -Math.PI / 2;
  private elevation = HOME_ELEVATION;
  private distance = 0.25;
  private home = { target: new Vector3(), distance: 0.25 };

  constructor() {
    this.camera.up.set(0, 0, 1);
    this.place();
  }

  /** Looks at the whole of a box, from the surgeon's side. */
  frame(box: Box3): void {
    const size = box.getSize(new Vector3());
    box.getCenter(this.target);
    this.distance = Math.max(0.66 * Math.max(size.x, 1.35 * size.y, size.z) / Math.tan((FIELD_OF_VIEW * Math.PI) / 360) / 1.25, 0.02);
    this.home = { target: this.target.clone(), distance: this.distance };
    this.reset();
  }

  reset(): void {
    this.target.copy(this.home.target);
    this.distance = this.home.distance;
    this.azimuth = -Math.PI / 2;
    this.elevation = HOME_ELEVATION;
    this.place();
  }

  turn(byAzimuth: number, byElevation: number): void {
    this.azimuth += byAzimuth;
    this.elevation = Math.min(Math.max(this.elevation + byElevation, -STEEPEST), STEEPEST);
    this.place();
  }

  zoom(factor: number): void {
    this.distance = Math.min(Math.max(this.distance * factor, 0.01), 5);
    this.place();
  }

  /** Moves the target by a share of the picture's height. */
  pan(right: number, up: number): void {
    const height = 2 * this.distance * Math.tan((this.camera.fov * Math.PI) / 360);
    const { x, y } = this.axes();
    this.target.addScaledVector(x, -right * height).addScaledVector(y, -up * height);
    this.place();
  }

  /** The picture's right, up, and towards the eye, in the world. */
  axes(): { x: Vector3; y: Vector3; z: Vector3 } {
    const [x, y, z] = [new Vector3(), new Vector3(), new Vector3()];
    this.camera.matrixWorld.extractBasis(x, y, z);
    return { x, y, z };
  }

  /** From the eye through a place of the picture, both coordinates from -1 to 1. */
  ray(x: number, y: number): { origin: Vector3; direction: Vector3 } {
    const origin = new Vector3().setFromMatrixPosition(this.camera.matrixWorld);
    return { origin, direction: new Vector3(x, y, 0.5).unproject(this.camera).sub(origin).normalize() };
  }

  /** Where a point is in the picture, both coordinates from -1 to 1. */
  picturePlace(point: Vector3): { x: number; y: number } {
    const { x, y } = point.clone().project(this.camera);
    return { x, y };
  }

  resize(width: number, height: number): void {
    const aspect = width / Math.max(height, 1);
    this.camera.aspect = aspect;
    const half = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    this.camera.fov = aspect >= 1.2 ? FIELD_OF_VIEW : (Math.atan((half * 1.2) / aspect) * 360) / Math.PI;
    this.camera.updateProjectionMatrix();
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
