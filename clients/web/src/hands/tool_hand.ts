// SPDX-License-Identifier: GPL-3.0-or-later
// The hand on the chosen tool: where it wants the tip (local echo), what the daemon is told of it, and
// energy that is on only while it is held.
import { Quaternion, Vector3 } from 'three';

import { hasHeat, hasJaws } from '../model/tool_parts';
import type { Control } from '../model/control';
import type { Model } from '../model/model';
import type { Pose, Viewport } from '../scene/viewport';
import { pick } from '../model/pick';
import { PARAMETERS } from '../wire/messages.gen';

export type Guide = 'surface' | 'plane';

const ECHO_MS = 400; // after this without a motion the server's pose is drawn
const HEARTBEAT_MS = 100;
const IDLE_HEARTBEAT_MS = 1000;
const SEND_MS = 1000 / 120;

export class ToolHand {
  /** over the surface, or in the plane of the picture through the tip */
  guide: Guide = 'surface';
  /** m above (positive) or in the surface, towards the eye */
  depthM = 0.002;
  energyHeld = false;
  private wanted: { position: Vector3; rotation: Quaternion; jaw: number } | null = null;
  private shown = new Vector3();
  private movedAt = -Infinity;
  private sentAt = -Infinity;
  private unsent = false;
  private sequence = 0;
  private lastAdvance = performance.now();
  private lastHeartbeat = 0;
  private tool: string | null = null;
  private taking = false;

  constructor(
    private readonly model: Model,
    private readonly control: Control,
    private readonly viewport: Viewport,
  ) {
    model.on('tools', () => this.follow());
    setInterval(() => this.heartbeat(), HEARTBEAT_MS);
    document.addEventListener('visibilitychange', () => document.hidden && this.hide());
    window.addEventListener('blur', () => this.hide());
    window.addEventListener('focus', () => this.control.link.heartbeat(true));
  }

  get mayHeat(): boolean {
    return this.model.driving && this.model.tool !== null && hasHeat(this.model.tool.shape);
  }

  get mayGrasp(): boolean {
    return this.model.driving && this.model.tool !== null && hasJaws(this.model.tool.shape);
  }

  /** Points at a place of the picture, both from -1 to 1. True if the tool goes there, or soon will. */
  pointAt(x: number, y: number): boolean {
    if (!this.begin()) return this.takeUp();
    const wanted = this.wanted!;
    const { camera } = this.viewport.orbit;
    const origin = new Vector3().setFromMatrixPosition(camera.matrixWorld);
    const direction = new Vector3(x, y, 0.5).unproject(camera).sub(origin).normalize();
    const towardsEye = this.viewport.orbit.axes().z;
    const place = this.guide === 'surface' ? this.onSurface(origin, direction) : null;
    if (place) {
      wanted.position.copy(place).addScaledVector(towardsEye, this.depthM);
    } else {
      const along = wanted.position.clone().sub(origin).dot(towardsEye) / direction.dot(towardsEye);
      wanted.position.copy(origin).addScaledVector(direction, along);
    }
    this.moved();
    return true;
  }

  /** Moves by metres to the picture's right, up, and towards the eye. */
  nudge(right: number, up: number, nearer: number): void {
    if (!this.begin()) return;
    const { x, y, z } = this.viewport.orbit.axes();
    this.wanted!.position.addScaledVector(x, right).addScaledVector(y, up).addScaledVector(z, nearer);
    this.depthM += nearer;
    this.moved();
  }

  turn(aboutShaft: number, tilt: number): void {
    if (!this.begin()) return;
    const { x } = this.viewport.orbit.axes();
    const { rotation } = this.wanted!;
    rotation.multiply(new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), aboutShaft));
    rotation.premultiply(new Quaternion().setFromAxisAngle(x, tilt)).normalize();
    this.moved();
  }

  setJaw(jaw: number): void {
    if (!this.begin()) return;
    this.wanted!.jaw = Math.min(Math.max(jaw, 0), 1);
    this.moved();
  }

  energize(on: boolean): void {
    if (on === this.energyHeld || (on && !this.mayHeat)) return;
    this.energyHeld = on;
    const tool = this.tool;
    if (tool === null) return;
    this.sequence++;
    this.say(this.control.call('tool.energize', { tool, sequence: this.sequence, energized: on }));
    this.model.emit('tools', undefined);
  }

  grasp(closed: boolean): void {
    if (!this.mayGrasp || this.tool === null) return;
    this.sequence++;
    const method = closed ? 'tool.grasp' : 'tool.release';
    this.say(this.control.call(method, { tool: this.tool, sequence: this.sequence }));
  }

  /** Poses to draw instead of the server's, and motion to the daemon; once per animation frame. */
  advance(): ReadonlyMap<string, Pose> {
    const now = performance.now();
    const seconds = Math.min((now - this.lastAdvance) / 1000, 0.1);
    this.lastAdvance = now;
    this.sendMotion(now);
    const poses = new Map<string, Pose>();
    if (!this.wanted || this.tool === null || !this.model.driving) return poses;
    const state = this.model.toolState;
    if (now - this.movedAt > ECHO_MS) {
      if (state) this.shown.set(...state.positionM);
      return poses;
    }
    const speed = this.model.tool?.max_speed_m_s ?? PARAMETERS.tool.find((p) => p.name === 'max_speed_m_s')!.default;
    const way = this.wanted.position.clone().sub(this.shown);
    this.shown.addScaledVector(way, Math.min(1, (speed * seconds) / Math.max(way.length(), 1e-9)));
    const { x, y, z, w } = this.wanted.rotation;
    poses.set(this.tool, { positionM: this.shown.toArray(), rotation: [w, x, y, z], jaw: this.wanted.jaw });
    return poses;
  }

  /** Becomes the driver of a tool that nobody drives. */
  private takeUp(): boolean {
    const { tool, model } = this;
    if (this.taking) return true;
    if (tool === null || !model.mayOperate || model.drivers.get(tool)?.client !== 0) return false;
    this.taking = true;
    this.say(this.control.takeOver(tool).finally(() => (this.taking = false)));
    return true;
  }

  /** Takes the tool's present pose up, if this page may move it. */
  private begin(): boolean {
    const state = this.model.toolState;
    if (!this.model.driving || !state) return false;
    if (this.wanted && performance.now() - this.movedAt < ECHO_MS) return true;
    const [w, x, y, z] = state.rotation;
    this.wanted = { position: new Vector3(...state.positionM), rotation: new Quaternion(x, y, z, w), jaw: state.jaw };
    this.shown.copy(this.wanted.position);
    this.sequence = Math.max(this.sequence, state.sequence);
    return true;
  }

  private moved(): void {
    this.movedAt = performance.now();
    this.unsent = true;
  }

  private onSurface(origin: Vector3, direction: Vector3): Vector3 | null {
    const { tissue } = this.viewport;
    if (!tissue) return null;
    const position = tissue.position.array as Float32Array;
    const hit = pick(origin.toArray(), direction.toArray(), position, tissue.visibleIndices());
    return hit && origin.clone().addScaledVector(direction, hit.distance);
  }

  private sendMotion(now: number): void {
    if (!this.unsent || !this.wanted || this.tool === null || now - this.sentAt < SEND_MS || !this.model.driving) return;
    this.unsent = false;
    this.sentAt = now;
    const { position, rotation, jaw } = this.wanted;
    this.control.link.notify('tool.move', {
      ...this.control.here(),
      tool: this.tool,
      sequence: ++this.sequence,
      position_m: position.toArray(),
      rotation: [rotation.w, rotation.x, rotation.y, rotation.z],
      jaw,
    });
  }

  private heartbeat(): void {
    if (document.hidden || !document.hasFocus()) return;
    const now = performance.now();
    if (!this.energyHeld && now - this.lastHeartbeat < IDLE_HEARTBEAT_MS) return;
    this.lastHeartbeat = now;
    this.control.link.heartbeat(true);
  }

  /** The page is out of sight or out of hand: energy goes off here and at the daemon. */
  private hide(): void {
    this.control.link.heartbeat(false);
    if (!this.energyHeld) return;
    this.energize(false);
    this.model.notice('warning', 'Energy is off: the page lost the focus.');
  }

  private follow(): void {
    if (this.tool !== this.model.selectedTool) {
      if (this.energyHeld) this.energize(false);
      this.tool = this.model.selectedTool;
      this.wanted = null;
      this.sequence = 0;
    }
    if (!this.model.driving) {
      this.wanted = null;
      this.energyHeld = false;
    }
  }

  private say(work: Promise<unknown>): void {
    work.catch((error: unknown) => {
      this.energyHeld = false;
      this.model.notice('error', error instanceof Error ? error.message : String(error));
      this.model.emit('tools', undefined);
    });
  }
}
