// SPDX-License-Identifier: GPL-3.0-or-later
// Moves the chosen tool. Mouse, finger, keys or stick aim at a point of the tissue, and the tool hovers over it. While
// something is held, the tool goes down and works: with heat if its shape has a hot part, else with its jaws. Using a
// free tool takes it.
import { Quaternion, Vector3 } from 'three';

import { hasHeat, toolSizes } from '../model/tool_parts';
import type { Control } from '../model/control';
import type { Model } from '../model/model';
import type { Pose, Viewport } from '../scene/viewport';
import { Aim } from './aim';
import { CuttingPace } from './cutting_pace';
import { Depths } from './depth';
import { Energy } from './energy';
import { Holds, LATCH, type HoldEvent, type Lost, type Press } from './holds';
import { Jaws } from './jaws';
import { Motion, type Wanted } from './motion';
import { Past } from './past';
import { Presence } from './presence';
import { Taking } from './taking';
import { Way } from './way';

export type Guide = 'surface' | 'plane';

const ECHO_MS = 400; // without a motion for this time, the pose of the server is drawn
const POINTED_MAX = 400; // capacity of a way
const HOVER_M = 0.003; // distance of tissue and hot part while the tool does not work

export class ToolHand {
  /** whether pointing moves the tool over the surface, or in the plane parallel to the screen through the tip */
  guide: Guide = 'surface';
  readonly depths = new Depths();
  readonly energy: Energy;
  private readonly holds = new Holds();
  readonly jaws: Jaws;
  readonly way = new Way();
  private readonly motion: Motion;
  private readonly taking: Taking;
  private readonly places: Aim;
  private readonly pace: CuttingPace;
  private readonly past: Past;
  private wanted: Wanted | null = null;
  /** point of the tissue at which the hand aims; null: the position of the tool */
  private aim: Vector3 | null = null;
  /** all points of the hand while the tool was being taken, so that a cut begins at the first of them */
  private pointed: { x: number; y: number }[] = [];
  private movedAt = -Infinity;
  private sequence = 0;
  private lastAdvance = performance.now();
  private tool: string | null = null;
  private driven = false;
  /** whether the tool has gone down to work and not risen since */
  private down = false;

  constructor(
    private readonly model: Model,
    control: Control,
    private readonly viewport: Viewport,
  ) {
    const sequence = (): number => ++this.sequence;
    this.energy = new Energy(model, control, sequence, this.holds, () => this.rest());
    this.jaws = new Jaws(model, control, sequence);
    this.motion = new Motion(control, sequence);
    this.taking = new Taking(model, control);
    this.places = new Aim(viewport);
    this.pace = new CuttingPace(model);
    model.on('tools', () => this.follow());
    this.past = new Past(model, () => {
      this.take({ type: 'leave', why: 'past' });
      this.rest();
    });
    new Presence(control.link, () => this.energy.wanted);
  }

  get driving(): boolean { return this.model.driving; }

  get mayHeat(): boolean { return this.driving && this.model.tool !== null && hasHeat(this.model.tool.shape); }

  /** Whether this page may use the chosen tool: it drives the tool, or the tool has no driver. */
  get usable(): boolean {
    return this.model.mayOperate && this.tool !== null && (this.model.driving || this.model.driver === null);
  }

  /** Depth below the surface, m. */
  get depthM(): number { return this.depths.of(this.tool); }

  /** Whether a point of the picture is on the tissue or in a gap of it; both coordinates from -1 to 1. */
  overTissue(x: number, y: number): boolean { return this.places.onSurface(x, y) !== null; }

  /** Moves a tool that this page drives to a point of the picture. Beside the tissue the tool stays. */
  hover(x: number, y: number): void {
    if (!this.model.driving || !this.begin()) return;
    const place = this.places.onSurface(x, y);
    if (place) this.aimAt(x, y, place);
  }

  /** Begins a new motion of pointing. */
  press(): void { this.pointed = []; }

  /** Points at a point of the picture: takes a free tool and moves it there. Returns false if the page may not. */
  pointAt(x: number, y: number): boolean {
    if (this.past.refuses()) return false;
    if (!this.begin()) {
      if (this.pointed.length < POINTED_MAX) this.pointed.push({ x, y });
      return this.taking.use();
    }
    this.aimAt(x, y);
    return true;
  }

  /** Whether something is held, or is pressed and does not count yet. */
  get pressed(): boolean { return this.holds.pressed; }

  /** Handles an event of a hold. The tool works while something is held. */
  take(event: HoldEvent): void {
    if (event.type === 'press' && this.past.refuses()) return;
    const lost = this.holds.take(event);
    if (lost) this.lost(lost);
    else if ((event.type === 'press' && event.ripe) || event.type === 'ripe') this.hold(event);
  }

  /** Begins or ends the latch, which keeps energy on without a hold. */
  latch(): void {
    if (this.holds.latched) this.take({ type: 'release', id: LATCH });
    else this.take({ type: 'press', by: 'latch', id: LATCH, place: 'latch', ripe: true });
  }

  private hold({ id, type }: Press | { type: 'ripe'; id: string }): void {
    if (!this.holds.held) return;
    if (!this.model.driving) {
      if (!this.taking.use()) this.holds.take({ type: 'release', id });
    } else if (!this.energy.alive) {
      this.work(true);
    } else if (type === 'press' && id === LATCH) {
      this.energy.limitByLatch();
    }
  }

  /** Handles the end of the last hold. */
  private lost(why: Lost): void {
    this.pointed = this.pointed.slice(-1); // a tool that is still being taken only moves to the last point
    this.energy.off(why);
    this.rest();
  }

  /** Moves by metres to the picture's right, up, and towards the eye. */
  nudge(right: number, up: number, nearer: number): void {
    if (this.past.refuses()) return;
    if (!this.begin()) return void this.taking.use();
    const { x, y, z } = this.viewport.orbit.axes();
    if (this.guide === 'plane') {
      this.moveTo(this.wanted!.position.clone().addScaledVector(x, right).addScaledVector(y, up).addScaledVector(z, nearer));
      return;
    }
    this.depths.change(this.tool!, -nearer);
    if (nearer !== 0) this.model.emit('tools', undefined);
    const aim = this.aim ?? this.places.under(this.wanted!.position);
    const at = this.viewport.orbit.picturePlace(aim.clone().addScaledVector(x, right).addScaledVector(y, up));
    this.aimAt(at.x, at.y);
  }

  resetDepth(): void {
    if (this.tool === null) return;
    this.depths.reset(this.tool);
    this.nudge(0, 0, 0);
    this.model.emit('tools', undefined);
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

  /** Sends motions, and returns the poses to draw instead of the server's; called once per animation frame. */
  advance(): ReadonlyMap<string, Pose> {
    const now = performance.now();
    const seconds = Math.min((now - this.lastAdvance) / 1000, 0.1);
    this.lastAdvance = now;
    const poses = new Map<string, Pose>();
    if (!this.wanted || this.tool === null || !this.model.driving) return poses;
    this.goOn(seconds);
    this.motion.send(now, this.tool, this.wanted);
    if (this.way.empty) this.jaws.arrived(this.wanted.position);
    if (now - this.movedAt > ECHO_MS) return poses;
    const { position, rotation: { x, y, z, w }, jaw } = this.wanted;
    poses.set(this.tool, { positionM: position.toArray(), rotation: [w, x, y, z], jaw });
    return poses;
  }

  /** Moves along the way at the largest speed of the tool, or while cutting, as fast as heat parts tissue. */
  private goOn(seconds: number): void {
    const { way, wanted } = this;
    if (!wanted) return;
    if (this.energy.wanted && !this.energy.alive && this.mayHeat) way.clear(); // without energy the cut does not continue
    if (way.empty) return;
    const fastest = toolSizes(this.model.tool!).maxSpeed * seconds;
    way.follow(wanted.position, this.energy.alive ? Math.min(this.pace.metresFrom(wanted.position), fastest) : fastest);
    this.moved();
  }

  private work(fresh: boolean): void {
    if (this.tool === null || !this.begin()) return;
    if (this.mayHeat) this.energy.enable(this.tool, fresh);
    this.jaws.press();
    this.lower();
  }

  /** Ends the work: drops the rest of the way and raises the tool. */
  private rest(): void {
    this.jaws.letGo();
    this.pace.from = null;
    this.way.clear();
    if (this.down && this.wanted && this.guide === 'surface') this.rise();
    this.down = false;
    this.viewport.invalidate();
  }

  /** Lowers the tool straight to its working position. */
  private lower(): void {
    if (!this.wanted || this.guide === 'plane') return;
    const aim = this.aim ?? this.places.under(this.wanted.position);
    this.aim = aim;
    this.down = true;
    this.pace.from = this.over(aim);
    this.moveTo(this.pace.from, true);
  }

  /** Raises the tool from its present position, which may be behind the hand. */
  private rise(): void {
    const { z } = this.viewport.orbit.axes();
    this.aim = this.wanted!.position.clone().addScaledVector(z, this.depthM);
    this.moveTo(this.over(this.aim), true);
  }

  /** Aims at a point of the picture. `known` is the point of the tissue there, if it is already known. */
  private aimAt(x: number, y: number, known: Vector3 | null = null): void {
    const surface = this.guide === 'surface';
    const place = surface ? (known ?? this.places.onSurface(x, y)) : null;
    this.aim = place ?? this.places.inPlane(x, y, (surface && this.aim) || this.wanted!.position);
    this.moveTo(surface ? this.over(this.aim) : this.aim);
  }

  /** Returns the position of the tip for an aimed point: at its depth while the tool works, else above it. */
  private over(aim: Vector3): Vector3 {
    const { hot, shaft } = toolSizes(this.model.tool!);
    const heats = hasHeat(this.model.tool!.shape);
    const works = heats ? this.energy.alive : this.energy.wanted;
    const hover = works ? 0 : HOVER_M + (heats ? hot : shaft);
    return aim.clone().addScaledVector(this.viewport.orbit.axes().z, hover - this.depthM);
  }

  private moveTo(position: Vector3, straight = false): void {
    if (this.energy.alive && !straight) this.way.append(position);
    else this.way.to(position);
    this.movedAt = performance.now();
  }

  /** Starts from the present pose of the tool, if this page may move it. Grasping jaws will be open after a release. */
  private begin(): boolean {
    const state = this.model.toolState;
    if (!this.model.driving || !state || this.past.shown) return false;
    if (this.wanted && (!this.way.empty || performance.now() - this.movedAt < ECHO_MS)) return true;
    const [w, x, y, z] = state.rotation;
    this.wanted = { position: new Vector3(...state.asked.positionM), rotation: new Quaternion(x, y, z, w), jaw: state.grasping ? 1 : state.askedJaw };
    this.sequence = Math.max(this.sequence, state.sequence);
    return true;
  }

  private moved(): void {
    this.movedAt = performance.now();
    this.motion.unsent = true;
  }

  private follow(): void {
    if (this.tool !== this.model.selectedTool) {
      this.holds.take({ type: 'leave', why: 'released' });
      this.energy.off('released');
      this.tool = this.model.selectedTool;
      this.drop();
      this.sequence = 0;
      this.driven = false;
    }
    const { driving } = this.model;
    if (driving === this.driven) return;
    this.driven = driving;
    if (driving) this.taken();
    else this.drop();
  }

  /** Handles a tool that was just taken: it begins at the surface under the pointer. */
  private taken(): void {
    this.depths.reset(this.tool!);
    const [first, ...rest] = this.pointed;
    this.pointed = [];
    if (!this.begin()) return;
    if (first) this.aimAt(first.x, first.y);
    if (this.energy.wanted) this.work(false);
    for (const { x, y } of rest) this.aimAt(x, y);
    this.model.emit('tools', undefined);
  }

  private drop(): void {
    this.wanted = this.aim = this.pace.from = null;
    this.down = false;
    this.way.clear();
  }
}
