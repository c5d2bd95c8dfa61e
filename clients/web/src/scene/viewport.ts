// SPDX-License-Identifier: GPL-3.0-or-later
// The picture: tissue, the field around it, instruments, smoke. Draws only when something changed.
import { Color, Scene, Vector3, WebGLRenderer, type IUniform } from 'three';

import { MAP_OF, type Scalar } from '../model/colour_maps';
import { SCALAR } from '../model/tissue';
import { text } from '../text/text';
import type { Tool } from '../wire/messages.gen';
import type { ToolState } from '../wire/records';
import type { Frame, FrameBuffers, Joined } from '../wire/worker_messages';
import { ClipPlane } from './clip_plane';
import { Field } from './field';
import { ForceArrow } from './force_arrow';
import { framedPoints } from './framing';
import { placeLamp } from './lamp';
import { Orbit, type CameraPose } from './orbit';
import { FULL, Pace, type Detail } from './pace';
import { Samples } from './samples';
import { circleRadius, inCircle, Scope } from './scope';
import { placeShadows } from './shadows';
import { Shown } from './shown';
import { Smoke } from './smoke';
import { makeSharedUniforms, mapTexture, TissueView } from './tissue_view';
import { ToolViews } from './tool_views';
import { VesselViews } from './vessel_view';
import { WayView } from './way_view';

export interface ViewOptions {
  wireframe: boolean;
  hiddenLayers: ReadonlySet<string>;
  /** as tissue, or a scalar as colour */
  colouring: 'tissue' | Scalar;
  forceArrow: boolean;
}

export interface Pose {
  positionM: readonly [number, number, number];
  rotation: readonly [number, number, number, number];
  jaw: number;
}

const CHANNELS = { tissue: -1, exposure: 0, charring: 1, stress: SCALAR, temperature: SCALAR } as const;
const BODY_TEMPERATURE_C = 37;
const SHARPEN_MS = 300;

function makeRenderer(canvas: HTMLCanvasElement): WebGLRenderer | null {
  try {
    return new WebGLRenderer({ canvas, antialias: false, powerPreference: 'high-performance' });
  } catch {
    return null; // the page shows a message instead of the picture
  }
}

export class Viewport {
  readonly orbit = new Orbit();
  /** null: this browser has no WebGL 2; everything but the picture works */
  private readonly renderer: WebGLRenderer | null;
  private readonly samples: Samples | null;
  tissue: TissueView | null = null;
  picturesDrawn = 0;
  readonly shown = new Shown();
  private taken = false; // whether a frame of the session has arrived
  readonly pace: Pace | null;
  private contextLost = false;
  /** detail of moving pictures, from Pace */
  private moving: Detail = FULL;
  private detail: Detail = FULL; // detail of the drawn picture
  private changedAt = 0;
  private readonly scene = new Scene();
  private readonly shared = makeSharedUniforms();
  readonly clip = new ClipPlane(this.shared.clip);
  private readonly colourMaps = { cividis: this.shared.colourMap.value, heat: mapTexture('heat') };
  private readonly tools = new ToolViews(this.scene, this.shared.light);
  readonly smoke = new Smoke();
  private readonly arrow = new ForceArrow();
  private readonly way = new WayView();
  private readonly vessels = new VesselViews(this.shared);
  private readonly field: Field;
  private readonly scope = new Scope();
  private dark = true;
  /** through a trocar: round, with the light at the camera; else the open field */
  private throughTrocar = true;
  private readonly background: IUniform<Color> = { value: new Color() };
  private options: ViewOptions = { wireframe: false, hiddenLayers: new Set(), colouring: 'tissue', forceArrow: false };
  private states: ToolState[] = [];
  private dirty = true;
  private framed = false;
  /** session for which the camera was set; joining the session again keeps the camera */
  private session: string | null = null;
  /** first pose of the camera, instead of the first view */
  wantedPose: CameraPose | null = null;
  private lastDrawn = performance.now();

  constructor(
    readonly canvas: HTMLCanvasElement,
    /** CSS pixels at the picture's foot that buttons cover */
    private readonly coveredBelow: () => number,
  ) {
    this.renderer = makeRenderer(canvas);
    this.samples = this.renderer && new Samples(this.renderer);
    this.pace = this.renderer && new Pace(this.renderer.getContext() as WebGL2RenderingContext, (detail) => {
      this.moving = detail;
      this.invalidate();
    });
    canvas.addEventListener('webglcontextlost', () => {
      this.contextLost = true;
      this.shown.lose();
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.contextLost = false;
      this.pace?.reset();
      this.samples?.lose();
      this.resize();
    });
    this.field = new Field(this.shared, this.background);
    this.scene.add(this.vessels.group, this.field.group, this.scope.group, this.smoke.points, this.arrow.arrow, this.way.points);
    this.setTheme(true);
  }

  /** State of the graphics context. */
  get graphics(): 'ready' | 'lost' | 'none' {
    if (!this.renderer) return 'none';
    return this.contextLost ? 'lost' : 'ready';
  }

  setTheme(dark: boolean): void {
    this.background.value.set(dark ? 0x14181c : 0xdfe5e8);
    this.scene.background = this.background.value;
    this.field.setTheme(dark);
    this.dark = dark;
    this.invalidate();
  }

  setTrocar(trocar: boolean): void {
    this.throughTrocar = trocar;
    this.scope.group.visible = trocar;
    this.field.setTrocar(trocar);
    this.setTheme(this.dark);
    this.setOptions(this.options);
    const home = this.orbit.pose === null;
    this.resize();
    if (home) this.frameTissue();
  }

  /** Returns whether a point of the picture, both coordinates from -1 to 1, shows the scene. */
  sees(x: number, y: number): boolean {
    return !this.throughTrocar || inCircle(x, y, this.orbit.camera.aspect);
  }

  setSession(joined: Joined | null): void {
    if (this.tissue) {
      this.scene.remove(this.tissue.group);
      this.tissue.dispose();
      this.tissue = null;
    }
    this.taken = false;
    this.setTools([]);
    this.vessels.show([]);
    this.field.place(joined);
    if (joined) {
      this.tissue = new TissueView(joined, this.shared);
      this.scene.add(this.tissue.group);
      this.states = [];
      const { session } = joined.description.summary;
      if (session !== this.session) {
        this.frameTissue();
        this.framed = false; // once more when it is known where the tools are
      }
      this.session = session;
      this.setOptions(this.options);
    }
    this.invalidate();
  }

  /** Sets the definitions of the instruments, when they are added, removed or changed. */
  setTools(tools: readonly Tool[]): void {
    this.tools.setTools(tools);
    this.invalidate();
  }

  /** Takes the next frame to draw; returns the arrays of the last one. */
  takeFrame(frame: Frame): FrameBuffers | null {
    this.states = frame.past?.tools ?? frame.tools;
    this.taken = this.tissue !== null;
    if (!this.framed && this.tissue) {
      this.frameTissue();
      if (this.wantedPose) this.orbit.restore(this.wantedPose);
      this.wantedPose = null;
    }
    this.smoke.watch(frame);
    if (this.vessels.show((frame.past ?? frame).vessels) || frame.changed || this.options.forceArrow) this.invalidate();
    if (!this.tissue) return null;
    if (frame.changed) this.field.follow(frame.buffers.position);
    return this.tissue.take(frame);
  }

  /** Returns whether the ghost of an instrument is drawn at its commanded pose. */
  ghostOf(name: string): boolean {
    return this.tools.ghostOf(name);
  }

  /** Sets the poses at which instruments are drawn. */
  poseTools(poses: ReadonlyMap<string, Pose>): void {
    let changed = false;
    for (const state of this.states)
      if (this.tools.pose(state, poses.get(state.name), this.heatOf(state))) changed = true;
    if (!changed) return;
    placeShadows(this.shared, this.states, this.tools.solid, (state) => this.heatOf(state));
    this.invalidate();
  }

  /** Shows the remaining path of a tool. */
  showWay(way: readonly Vector3[]): void {
    if (this.way.show(way)) this.invalidate();
  }

  setOptions(options: ViewOptions): void {
    this.options = options;
    this.shared.mapChannel.value = CHANNELS[options.colouring];
    if (options.colouring !== 'tissue') this.shared.colourMap.value = this.colourMaps[MAP_OF[options.colouring]];
    this.tissue?.setWireframe(options.wireframe);
    for (const batch of this.tissue?.joined.batches ?? [])
      this.tissue?.showLayer(batch.layer, !options.hiddenLayers.has(batch.layer), !(this.throughTrocar && this.tissue.joined.surroundings?.inBody));
    this.invalidate();
  }

  invalidate(): void {
    this.dirty = true;
  }

  resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return; // hidden: pressed where it was as soon as it is back
    this.orbit.resize(width, height, this.coveredBelow(), this.throughTrocar ? circleRadius(width / height) : null);
    this.setDetail(this.moving);
    this.invalidate();
  }

  /** Draws if anything changed; called once per animation frame. */
  draw(): void {
    const now = performance.now();
    if (this.smoke.advance((now - this.lastDrawn) / 1000, this.states, this.tools.solid)) this.dirty = true;
    this.lastDrawn = now;
    if (!this.pace || this.contextLost || !this.pace.ready()) return;
    this.shown.finish();
    if (!this.dirty) {
      this.sharpen(now);
      return;
    }
    this.dirty = false;
    this.changedAt = now;
    if (this.detail !== this.moving) this.setDetail(this.moving); // here, since that clears the canvas
    this.render();
    this.pace.drawn(now);
  }

  /** Whether the picture is up to date and in full detail. */
  get idle(): boolean {
    return !this.dirty && this.pace !== null && this.pace.ready() && this.detail === FULL;
  }

  /** Draws an unchanged picture once more in full detail. */
  private sharpen(now: number): void {
    if (this.detail === FULL || now - this.changedAt < SHARPEN_MS) return;
    this.setDetail(FULL);
    this.render();
  }

  private render(): void {
    placeLamp(this.shared, this.orbit, this.throughTrocar, this.dark);
    this.arrow.place(this.options.forceArrow, this.states);
    const draw = (): void => this.renderer?.render(this.scene, this.orbit.camera);
    if (this.detail.smooth) this.samples?.draw(draw);
    else draw();
    this.shown.draw(this.taken ? this.session : null);
    this.picturesDrawn++;
  }

  private setDetail(detail: Detail): void {
    const { clientWidth, clientHeight } = this.canvas;
    this.detail = detail;
    this.renderer?.setPixelRatio(Math.min(window.devicePixelRatio, 2) * detail.scale);
    this.renderer?.setSize(clientWidth, clientHeight, false);
    this.smoke.resize(this.canvas.height);
    this.scope.resize(this.canvas.width, this.canvas.height);
  }

  /** time of the last picture, ms */
  get pictureMs(): number {
    return this.pace?.pictureMs ?? 0;
  }

  /** Returns the position of a point of the world in the page, CSS pixels. */
  project(point: readonly [number, number, number]): { x: number; y: number } {
    const at = new Vector3(...point).project(this.orbit.camera);
    const box = this.canvas.getBoundingClientRect();
    return { x: box.left + ((at.x + 1) / 2) * box.width, y: box.top + ((1 - at.y) / 2) * box.height };
  }

  /** Returns the picture as PNG. */
  async png(): Promise<Blob> {
    if (this.graphics !== 'ready') throw new Error(text.viewport.noPicture);
    this.setDetail(FULL);
    this.render();
    const written = new Promise<Blob>((resolve, reject) => this.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error(text.viewport.notWritten))), 'image/png'));
    return written.finally(() => this.resize());
  }

  private frameTissue(): void {
    const all = this.tissue?.joined.surroundings?.all;
    if (!all) return;
    this.orbit.frame(framedPoints(all, this.states, this.throughTrocar));
    this.framed = true;
  }

  private heatOf(state: ToolState): number {
    if (!state.energized) return 0;
    return Math.min(Math.max((state.tipTemperatureC - BODY_TEMPERATURE_C) / 130, 0.15), 1);
  }
}
