// SPDX-License-Identifier: GPL-3.0-or-later
// The state of the page: the connection, the sessions, the watched session with its newest frame, and the drivers of tools.
// Panels and the picture listen to its events; the model does not know them.
import type { LinkState } from '../wire/connection';
import type {
  Driver,
  FrameProgress,
  HelloResult,
  Instrument,
  Pushes,
  SceneSummary,
  SessionSummary,
  TakeoverRequested,
  Timeline,
  Tool,
} from '../wire/messages.gen';
import type { ToolState } from '../wire/records';
import { History } from './history';
import type { Frame, Joined, Sample } from '../wire/worker_messages';

export interface Events {
  link: LinkState;
  sessions: readonly SessionSummary[];
  joined: Joined | null;
  /** definitions of tools, drivers, or the chosen tool changed */
  tools: undefined;
  frame: Frame;
  timeline: Timeline | null;
  /** past tick that is viewed; null: the newest */
  held: number | null;
  /** progress of the daemon in loading the viewed tick */
  looking: FrameProgress;
  takeover: TakeoverRequested | null;
  notice: Notice;
  said: Said;
  unsaid: string;
}

/** A message to the user. */
export interface Notice {
  kind: 'info' | 'warning' | 'error';
  words: string;
}

/** A message at the tool, where the user looks. */
export interface Said extends Notice {
  /** the message stays until `unsay` with this key; without a key it disappears by itself */
  key?: string;
  /** numbers after the text, which may change; a screen reader does not read each change */
  figures?: string;
  action?: { words: string; press: () => void };
}

type Listener<T> = (value: T) => void;

const SAMPLES_MAX = 7200; // two minutes at 60 a second
const EVENTS_MAX = 4096;

export class Model {
  link: LinkState = { state: 'connecting' };
  hello: HelloResult | null = null;
  scenes: readonly SceneSummary[] = [];
  instruments: readonly Instrument[] = [];
  sessions: readonly SessionSummary[] = [];
  elsewhere: readonly SessionSummary[] = [];
  silent: readonly string[] = [];
  /** id of the session that is or will be watched */
  session: string | null = null;
  joined: Joined | null = null;
  frame: Frame | null = null;
  drivers = new Map<string, Driver>();
  selectedTool: string | null = null;
  timeline: Timeline | null = null;
  takeover: TakeoverRequested | null = null;
  samples: Sample[] = [];
  readonly history = new History();
  /** tick at which the timeline is held; null while it follows the session */
  held: number | null = null;
  private readonly listeners = new Map<keyof Events, Set<Listener<never>>>();

  on<K extends keyof Events>(event: K, listener: Listener<Events[K]>): void {
    const set = this.listeners.get(event) ?? new Set();
    set.add(listener);
    this.listeners.set(event, set);
  }

  emit<K extends keyof Events>(event: K, value: Events[K]): void {
    for (const listener of this.listeners.get(event) ?? []) (listener as Listener<Events[K]>)(value);
  }

  notice(kind: Notice['kind'], words: string): void {
    this.emit('notice', { kind, words });
  }

  /** Shows a message at the tool. With a key it stays until `unsay`. */
  say(kind: Notice['kind'], words: string, more: Pick<Said, 'key' | 'figures' | 'action'> = {}): void {
    this.emit('said', { kind, words, ...more });
  }

  unsay(key: string): void {
    this.emit('unsaid', key);
  }

  get summary(): SessionSummary | null {
    return this.sessions.find((summary) => summary.session === this.session) ?? null;
  }

  get mayOperate(): boolean {
    return this.link.state === 'online' && this.hello !== null && this.hello.role !== 'view';
  }

  /** Definitions of the session's tools. */
  get tools(): readonly Tool[] {
    return this.joined?.description.definition.tools ?? [];
  }

  get tool(): Tool | null {
    return this.tools.find((tool) => tool.name === this.selectedTool) ?? null;
  }

  get toolState(): ToolState | null {
    return this.frame?.tools.find((tool) => tool.name === this.selectedTool) ?? null;
  }

  /** Whether this page drives the chosen tool. */
  get driving(): boolean {
    return this.selectedTool !== null && this.drives(this.selectedTool);
  }

  /** Whether this page drives a tool. */
  drives(tool: string): boolean {
    const driver = this.drivers.get(tool);
    return this.mayOperate && driver !== undefined && driver.client === this.hello?.client;
  }

  /** Returns the driver of the chosen tool; null: no driver. */
  get driver(): Driver | null {
    const driver = this.selectedTool === null ? undefined : this.drivers.get(this.selectedTool);
    return driver && driver.client !== 0 ? driver : null;
  }

  setLink(link: LinkState): void {
    this.link = link;
    if (link.state === 'online') this.hello = link.hello;
    this.emit('link', link);
    this.emit('tools', undefined);
  }

  setSessions(sessions: readonly SessionSummary[]): void {
    this.sessions = [...sessions].sort((a, b) => a.session.localeCompare(b.session));
    this.emit('sessions', this.sessions);
  }

  /** Sets the sessions of the other daemons of a fleet, and the labels of daemons that do not answer. */
  setElsewhere(sessions: readonly SessionSummary[], silent: readonly string[]): void {
    this.elsewhere = [...sessions].sort((a, b) => a.session.localeCompare(b.session));
    this.silent = silent;
    this.emit('sessions', this.sessions);
  }

  putSession(summary: SessionSummary): void {
    this.setSessions([...this.sessions.filter((other) => other.session !== summary.session), summary]);
  }

  removeSession(session: string): void {
    this.setSessions(this.sessions.filter((other) => other.session !== session));
  }

  setJoined(joined: Joined | null): void {
    const another = joined?.description.summary.session !== this.joined?.description.summary.session;
    this.joined = joined;
    if (another) {
      this.frame = null;
      this.samples = [];
      this.history.clear();
      this.hold(null);
      this.timeline = null;
    }
    this.drivers = new Map(joined?.description.drivers.map((driver) => [driver.tool, driver]));
    if (!this.tool) this.selectedTool = this.tools[0]?.name ?? null;
    if (joined) this.putSession(joined.description.summary);
    this.emit('joined', joined);
    this.emit('tools', undefined);
  }

  setTools(tools: Tool[], drivers: readonly Driver[]): void {
    if (!this.joined) return;
    this.joined.description.definition.tools = tools;
    this.drivers = new Map(drivers.map((driver) => [driver.tool, driver]));
    if (!this.tool) this.selectedTool = tools[0]?.name ?? null;
    this.emit('tools', undefined);
  }

  setDriver(driver: Driver): void {
    this.drivers.set(driver.tool, driver);
    this.emit('tools', undefined);
  }

  selectTool(name: string): void {
    this.selectedTool = name;
    this.emit('tools', undefined);
  }

  setFrame(frame: Frame): void {
    const before = this.frame;
    this.frame = frame;
    this.samples.push(...frame.samples);
    for (const { moment } of frame.samples) this.history.take(moment);
    if (this.samples.length > SAMPLES_MAX) this.samples.splice(0, this.samples.length - SAMPLES_MAX);
    const drivers = frame.tools.map((tool) => tool.driver).join();
    if (before && drivers !== before.tools.map((tool) => tool.driver).join()) this.followDrivers(frame);
    this.emit('frame', frame);
  }

  setTimeline(timeline: Timeline | null): void {
    this.timeline = timeline;
    this.emit('timeline', timeline);
  }

  /** Begins to view a past tick, or the newest again with null. */
  hold(tick: number | null): void {
    if (tick === this.held) return;
    this.held = tick;
    this.emit('held', tick);
  }

  addEvent({ event }: Pushes['event']): void {
    const { timeline } = this;
    if (!timeline) return;
    const events = [...timeline.events, event].slice(-EVENTS_MAX);
    this.setTimeline({ ...timeline, tick: Math.max(timeline.tick, event.tick), events });
  }

  setTakeover(takeover: TakeoverRequested | null): void {
    this.takeover = takeover;
    this.emit('takeover', takeover);
  }

  /** Updates drivers from a frame, which has their numbers, in case a notification was missed. */
  private followDrivers(frame: Frame): void {
    for (const tool of frame.tools) {
      const known = this.drivers.get(tool.name);
      if (known && known.client !== tool.driver) this.drivers.set(tool.name, { ...known, client: tool.driver, name: '' });
    }
    this.emit('tools', undefined);
  }
}
