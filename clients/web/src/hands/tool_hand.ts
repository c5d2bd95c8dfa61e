// SPDX-License-Identifier: GPL-3.0-or-later
// The hand on the chosen tool. Whatever points (mouse, finger, keys, stick) aims at a place of the
// tissue; the tool hovers over it, and while something is held it goes down to it and works: heat where
// the shape has heat, jaws where it has only those. Using a free tool takes it.
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

const ECHO_MS = 400; // after this without a motion the server's pose is drawn
const POINTED_MAX = 400; // as many as a way holds
const HOVER_M = 0.003; // between tissue and the hot part of a tool that does not work

export class ToolHand {
  /** over the surface, or in the plane of the picture through the tip */
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
  /** the place of the tissue that is aimed at; null: where the tool is */
  private aim: Vector3 | null = null;
  /** where the hand pointed while the tool was still being taken, all of it: a cut begins at its beginning */
  private pointed: { x: number; y: number }[] = [];
  private movedAt = -Infinity;
  private sequence = 0;
  private lastAdvance = performance.now();
  private tool: string | null = null;
  private driven = false;
  /** it has gone down to work, and not risen since */
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

  /** Whether using the chosen tool moves it: it is this page's, or nobody's. */
  get usable(): boolean {
    return this.model.mayOperate && this.tool !== null && (this.model.driving || this.model.driver === null);
  }

  /** m, below the surface */
  get depthM(): number { return this.depths.of(this.tool); }

  /** Whether a place of the picture is on the tissue, gaps in it included; both coordinates from -1 to 1. */
  overTissue(x: number, y: number): boolean { return this.places.onSurface(x, y) !== null; }

  /** Leads a tool that is this page's to a place of the picture. Beside the tissue it stays. */
  hover(x: number, y: number): void {
    if (!this.model.driving || !this.begin()) return;
    const place = this.places.onSurface(x, y);
    if (place) this.aimAt(x, y, place);
  }

  /** Something begins to point anew. */
  press(): void { this.pointed = []; }

  /** Points at a place of the picture: takes a free tool, and leads it there. False: it may not. */
  pointAt(x: number, y: number): boolean {
    if (this.past.refuses()) return false;
    if (!this.begin()) {
      if (this.pointed.length < POINTED_MAX) this.pointed.push({ x, y });
      return this.taking.use();
    }
    this.aimAt(x, y);
    return true;
  }

  /** Something is held, or is about to count as held. */
  get pressed(): boolean { return this.holds.pressed; }

  /** Takes what happens to that which is held: the tool works as long as anything is. */
  take(event: HoldEvent): void {
    if (event.type === 'press' && this.past.refuses()) return;
    const lost = this.holds.take(event);
    if (lost) this.lost(lost);
    else if ((event.type === 'press' && event.ripe) || event.type === 'ripe') this.hold(event);
  }

  /** Keeps energy on without anything held, or ends that. */
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

  /** Nothing is held any more. */
  private lost(why: Lost): void {
    this.pointed = this.pointed.slice(-1); // a tool that is still being taken only comes there
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

  /** Poses to draw instead of the server's, and motion to the daemon; once per animation frame. */
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

  /** Goes along the way: as fast as the tool may, while it cuts as fast as heat parts tissue. */
  private goOn(seconds: number): void {
    const { way, wanted } = this;
    if (!wanted) return;
    if (this.energy.wanted && !this.energy.alive && this.mayHeat) way.clear(); // what went dark does not go on
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

  /** What was held is let go of: the rest of the way is dropped, and the tool rises. */
  private rest(): void {
    this.jaws.letGo();
    this.pace.from = null;
    this.way.clear();
    if (this.down && this.wanted && this.guide === 'surface') this.rise();
    this.down = false;
    this.viewport.invalidate();
  }

  /** Down to where it works, straight. */
  private lower(): void {
    if (!this.wanted || this.guide === 'plane') return;
    const aim = this.aim ?? this.places.under(this.wanted.position);
    this.aim = aim;
    this.down = true;
    this.pace.from = this.over(aim);
    this.moveTo(this.pace.from, true);
  }

  /** Up from where it is now, which may be behind where the hand is. */
  private rise(): void {
    const { z } = this.viewport.orbit.axes();
    this.aim = this.wanted!.position.clone().addScaledVector(z, this.depthM);
    this.moveTo(this.over(this.aim), true);
  }

  /** `known`: the place of the tissue there, where it has been looked up. */
  private aimAt(x: number, y: number, known: Vector3 | null = null): void {
    const surface = this.guide === 'surface';
    const place = surface ? (known ?? this.places.onSurface(x, y)) : null;
    this.aim = place ?? this.places.inPlane(x, y, (surface && this.aim) || this.wanted!.position);
    this.moveTo(surface ? this.over(this.aim) : this.aim);
  }

  /** Where the tip is for a place that is aimed at: in it while the tool works, else over it. */
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

  /** Takes the tool's present pose up, if this page may move it; jaws that grasp are open once they let go. */
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

  /** The tool has come into this hand: it begins at the surface, where the hand points. */
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
