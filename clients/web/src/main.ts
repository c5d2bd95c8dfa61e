// SPDX-License-Identifier: GPL-3.0-or-later
// The page: creates all modules and connects them.
import { Box3 } from 'three';

import { Aim } from './hands/aim';
import { watchHolds } from './hands/hold_watch';
import { Keys } from './hands/keys';
import { Pedal } from './hands/pedal';
import { PinBrush } from './hands/pin_brush';
import { Pointer } from './hands/pointer';
import { Ruler } from './hands/ruler';
import { SpaceMouse } from './hands/space_mouse';
import { ToolHand } from './hands/tool_hand';
import { Control } from './model/control';
import { keepToken, takeToken } from './model/kept_token';
import { Model } from './model/model';
import { clientWords } from './model/person';
import { keepAddress, readAddress } from './panels/address';
import { clipFields } from './panels/clip';
import { showCue } from './panels/cue';
import { devicesSection } from './panels/devices';
import { byId } from './panels/dom';
import { keepFleet } from './panels/fleet';
import { showInspected } from './panels/inspect';
import { materialsPanel } from './panels/materials';
import { showHandles } from './panels/handles';
import { modeSwitch } from './panels/mode';
import { operatePanel } from './panels/operate';
import { showHelp, showLink, showNotices, showReading } from './panels/overlay';
import { plotsPanel } from './panels/plots';
import { showRuler } from './panels/ruler';
import { showSaid } from './panels/said';
import { sensesSection } from './panels/senses';
import { saveReceived, sessionsPanel } from './panels/sessions';
import { showPast } from './panels/past';
import { makeTabs } from './panels/tabs';
import { timeBar } from './panels/time';
import { askForToken } from './panels/token';
import { toolsPanel } from './panels/tools';
import { showVeil } from './panels/veil';
import { watchVessels } from './panels/vessels';
import { viewPanel } from './panels/view';
import { Sounds } from './scene/sound';
import { Viewport } from './scene/viewport';
import { labelPage } from './text/document';
import { text } from './text/text';
import { Link } from './wire/link';
import { SCALARS, type Layer, type Tool } from './wire/messages.gen';
import { errorWords } from './model/sentences';

labelPage();

const model = new Model();
const picture = byId<HTMLCanvasElement>('picture');
const handles = byId('handles');
const viewport = new Viewport(picture, () => picture.getBoundingClientRect().bottom - handles.getBoundingClientRect().top);
const address = readAddress();
viewport.wantedPose = address.camera;

const link: Link = new Link({
  state: (state) => {
    model.setLink(state);
    if (state.state === 'online')
      control.refresh().catch((error: unknown) => model.notice('error', errorWords(error)));
  },
  joined: (joined) => {
    viewport.setSession(joined);
    model.setJoined(joined);
  },
  moved: (session, to, url) => {
    if (session === model.session) follow(to, url);
  },
  notJoined: (session, message) => model.notice('error', text.main.notOpened(session, message)),
  frame: (frame) => {
    const buffers = viewport.takeFrame(frame);
    model.setFrame(frame);
    link.giveBack(buffers ?? frame.buffers);
  },
  push: (method, params) => control.push(method, params),
  file: (name, mediaType, bytes, sound) => {
    if (!sound) model.notice('error', text.main.damaged(name));
    else saveReceived(name, mediaType, bytes);
  },
});
const control = new Control(model, link);
const sounds = new Sounds(model);
const hand = new ToolHand(model, control, viewport);
const ruler = new Ruler(new Aim(viewport));
const pins = new PinBrush(new Aim(viewport), (selection) => {
  control.call('pin', { selection }).catch((error: unknown) => model.notice('error', errorWords(error)));
});
const pointer = new Pointer(viewport.canvas, viewport, hand, ruler, pins);
const pedal = new Pedal((event) => hand.take(event));
watchHolds(hand);
let spaceMouse: SpaceMouse | null = null;
const makeSpaceMouse = (changed: () => void): SpaceMouse => {
  spaceMouse = new SpaceMouse({
    nudge: (right, up, nearer) => hand.nudge(right, up, nearer),
    turn: (aboutShaft, tilt) => hand.turn(aboutShaft, tilt),
    hold: () => hand.take({ type: 'press', by: 'cap', id: 'cap', place: null, ripe: true }),
    letGo: (unplugged) => hand.take({ type: 'release', id: 'cap', why: unplugged ? 'unplugged' : 'released' }),
  }, changed);
  return spaceMouse;
};
const keys = new Keys(viewport.canvas, viewport, hand, () => model.toolState?.grasping === true);

model.on('tools', () => viewport.setTools(model.tools));
model.on('joined', (joined) => {
  if (!joined) viewport.setSession(null);
});

const inspect = showInspected(control, viewport);
const clip = clipFields(control, viewport);
const tabs = makeTabs([sessionsPanel(control, link, () => toResearch('sessions')), toolsPanel(control, hand), materialsPanel(control), viewPanel(control, viewport, inspect.switch, clip.fields), plotsPanel(model)]);
timeBar(control, address.tick);
showPast(control);
showHandles(control, hand, pointer);
const placeSaid = showSaid(model, viewport, pointer);
watchVessels(model);
showNotices(control);
showReading(control);
showHelp();
operatePanel(control, hand, viewport, { token: () => lastToken, rename: () => connect(lastToken) }, [sensesSection(viewport, sounds), devicesSection(pedal, makeSpaceMouse)]);
const chooseMode = modeSwitch((mode) => {
  tabs.show(mode === 'research');
  if (mode === 'research') return;
  // Operate has no inspection tools, so their effects must end.
  clip.off();
  inspect.off();
  if (pointer.press !== 'measure' && pointer.press !== 'pin') return;
  pointer.press = 'work';
  model.emit('tools', undefined);
});
/** Brings a panel to the front. */
function toResearch(panel: string): void {
  chooseMode('research');
  tabs.open(panel);
}
const placeCue = showCue(control, viewport);
const placeRuler = showRuler(ruler, viewport);
keepAddress(model, viewport);

let lastToken: string | undefined;

function socketAddress(session: string | null): string {
  const url = new URL('./v1', window.location.href);
  url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
  url.search = session === null ? '' : `session=${encodeURIComponent(session)}`;
  url.hash = '';
  return url.href;
}

/** Follows a session to another daemon. A page may connect only to its own address, so for another address the page of
 * that daemon is opened. */
function follow(session: string, daemon: string): void {
  const there = daemon === '' ? null : new URL(daemon);
  model.notice('info', text.main.moved(session));
  if (there && there.host !== window.location.host) {
    there.protocol = there.protocol === 'wss:' || there.protocol === 'https:' ? 'https:' : 'http:';
    there.pathname = '/';
    there.search = `session=${encodeURIComponent(session)}`;
    window.location.assign(there.href);
    return;
  }
  // Behind a proxy, the page of each daemon is under its label.
  const [label, old] = [session, model.session ?? ''].map((id) => id.split('-')[0]);
  if (window.location.pathname === `/${old}/`) {
    window.location.assign(`/${label}/?session=${encodeURIComponent(session)}`);
    return;
  }
  link.follow(socketAddress(session));
  control.watch(session);
}

function connect(token?: string): void {
  lastToken = token;
  const wanted = address.session;
  link.connect(socketAddress(wanted), clientWords(__VIEWER_VERSION__), token);
  const session = model.session ?? wanted;
  if (session !== null) control.watch(session);
}
showLink(control);
const openToken = askForToken(model, connect);
showVeil(control, viewport, openToken);
keepFleet(model, clientWords(__VIEWER_VERSION__), () => lastToken);
keepToken(model, () => lastToken);
connect(takeToken());

const sizes = new ResizeObserver(() => viewport.resize());
sizes.observe(viewport.canvas);
sizes.observe(handles);

function animate(): void {
  keys.advance();
  spaceMouse?.advance();
  viewport.poseTools(hand.advance());
  viewport.showWay(hand.energy.alive ? hand.way.rest() : []);
  viewport.draw();
  placeSaid();
  placeCue();
  placeRuler();
  requestAnimationFrame(animate);
}
requestAnimationFrame(animate);

/** The state of the page, for tests and for debugging. */
export interface Inspection {
  session: string | null;
  link: string;
  tick: number;
  epoch: string;
  paused: boolean;
  /** past tick that the picture shows; null: the present */
  past: number | null;
  drawnFaces: Readonly<Record<string, number>>;
  framesDecoded: number;
  framesSkipped: number;
  driving: boolean;
  energized: boolean;
  tip: readonly number[];
  /** commanded position of the tool in hand, and whether it is drawn there */
  asked: readonly number[];
  ghost: boolean;
  /** opening of the jaws of the tool in hand, 0 closed to 1 open; commanded opening; whether they hold tissue */
  jaw: number;
  askedJaw: number;
  grasping: boolean;
  tipTemperatureC: number | null;
  /** definition of the tool in hand */
  tool: Tool | null;
  pictureMs: number;
  picturesDrawn: number;
  /** number of smoke puffs */
  puffs: number;
  /** frequency of the activation tone, Hz, 0: off; loudness of the sizzle, 0 to 1; number of alarms */
  heard: { toneHz: number; sizzle: number };
  alarms: number;
  /** whether the picture is up to date */
  idle: boolean;
  /** latencies of recent frames, from publishing to decoding, ms */
  latenciesMs(): number[];
  /** newest definition of a layer from the daemon */
  layer(name: string): Layer | null;
  /** whether tissue of a layer is drawn over a point of the ground */
  drawnAt(layer: string, x: number, y: number): boolean;
  /** degC at the vertex nearest to a point, as its colour tells it; null where temperature is not shown */
  temperatureAt(point: readonly [number, number, number]): number | null;
  /** place and depth of blood of each vertex, m; null where the picture has no blood */
  blood(): { at: number[]; depthM: number }[] | null;
  /** least and largest x, y, z of the tissue, m */
  extent(): { least: number[]; most: number[] };
  project(point: readonly [number, number, number]): { x: number; y: number };
  /** pictures in full detail, however slow, or again as quick as the machine needs them */
  holdFull(held: boolean): void;
}

const inspection: Inspection = {
  get session() { return model.joined?.description.summary.session ?? null; },
  get link() { return model.link.state; },
  get tick() { return model.frame?.tick ?? -1; },
  get epoch() { return model.frame?.epoch ?? ''; },
  get paused() { return model.frame?.paused ?? false; },
  get past() { return model.frame?.past?.tick ?? null; },
  get drawnFaces() { return model.frame?.drawnFaces ?? {}; },
  get framesDecoded() { return model.frame?.framesDecoded ?? 0; },
  get framesSkipped() { return model.frame?.framesSkipped ?? 0; },
  get driving() { return model.driving; },
  get energized() { return model.toolState?.energized ?? false; },
  get tip() { return model.toolState?.positionM ?? []; },
  get asked() { return model.toolState?.asked.positionM ?? []; },
  get ghost() { return model.toolState !== null && viewport.ghostOf(model.toolState.name); },
  get askedJaw() { return model.toolState?.askedJaw ?? 1; },
  get jaw() { return model.toolState?.jaw ?? 1; },
  get grasping() { return model.toolState?.grasping ?? false; },
  get tipTemperatureC() { return model.toolState?.tipTemperatureC ?? null; },
  get tool() { return model.tool; },
  get pictureMs() { return viewport.pictureMs; },
  get picturesDrawn() { return viewport.picturesDrawn; },
  get puffs() { return viewport.smoke.count; },
  get heard() { return sounds.heard; },
  get alarms() { return sounds.alarms; },
  get idle() { return viewport.idle; },
  latenciesMs: () => model.samples.map((sample) => sample.latencyMs),
  layer: (name) => model.joined?.description.definition.layers?.find((layer) => layer.name === name) ?? null,
  drawnAt: (layer, x, y) => viewport.tissue?.covers(layer, x, y) ?? false,
  temperatureAt: (point) => {
    const range = model.frame?.temperatureRangeC;
    return range && viewport.tissue ? range[0] + viewport.tissue.scalarAt(point) * (range[1] - range[0]) : null;
  },
  blood: () => (model.joined?.blood && viewport.tissue ? viewport.tissue.scalars().map(({ at, byte }) => ({ at, depthM: byte * SCALARS.blood.step })) : null),
  extent: () => {
    const { min, max } = new Box3().setFromArray(viewport.tissue?.position.array ?? []);
    return { least: min.toArray(), most: max.toArray() };
  },
  project: (point) => viewport.project(point),
  holdFull: (held) => viewport.pace?.holdFull(held),
};
Object.assign(window, { cautery: inspection });
