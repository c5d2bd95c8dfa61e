// SPDX-License-Identifier: GPL-3.0-or-later
// Connects model and daemon: sends requests of the user, and handles notifications of the daemon.
import { text } from '../text/text';
import type { Link } from '../wire/link';
import type { MaterialSet, Pushes, Requests, Scene, SessionDescription, Tool, ToolConfigure } from '../wire/messages.gen';
import { nameOf } from './person';
import type { Channels } from '../wire/worker_messages';
import type { Model } from './model';
import { errorWords } from './sentences';

/** Returns a warning for events after which the tissue cannot be trusted, although the session continues. */
function doubtOf({ kind, count = 0, detail = '' }: Pushes['event']['event']): string | null {
  if (kind === 'inverted') return text.control.inverted(count, detail);
  if (kind === 'energy_gain') return text.control.gained(detail);
  return null;
}

/** Channels that are always joined. The worker adds the channels of vessels if the scene has vessels. */
const CHANNELS: Channels = ['positions', 'mask', 'exposure', 'charring', 'tools', 'statistics'];
/** Channels that the daemon must compute: joined only while they are shown. */
export type ExtraChannel = 'stress' | 'temperature';
export class Control {
  /** running work for which the user waits, as in "Rewinding to 12.3 s" */
  readonly busy: string[] = [];
  private colour: ExtraChannel | null = null;
  private inspecting = false;

  constructor(
    readonly model: Model,
    readonly link: Link,
  ) {}

  /** Loads what may have changed meanwhile; called after every hello. */
  async refresh(): Promise<void> {
    const { scenes } = await this.link.call('scene.list', {});
    this.model.scenes = scenes;
    // A daemon of an earlier version has no such request.
    this.model.instruments = (await this.link.call('instrument.list', {}).catch(() => ({ instruments: [] }))).instruments;
    const { sessions } = await this.link.call('session.list', {});
    this.model.setSessions(sessions);
    if (this.model.session === null) {
      const first = sessions.find((summary) => summary.session.endsWith('-demo')) ?? sessions[0];
      if (first) this.watch(first.session);
    }
  }

  watch(session: string | null): void {
    const { model } = this;
    model.session = session;
    if (session === null) model.setJoined(null);
    const extra: ExtraChannel[] = this.inspecting ? ['stress', 'temperature'] : this.colour ? [this.colour] : [];
    this.link.watch(session, [...CHANNELS, ...extra], this.colour ?? 'blood');
    model.emit('sessions', model.sessions);
  }

  show(colour: ExtraChannel | null): void {
    if (colour === this.colour) return;
    this.colour = colour;
    if (this.model.session !== null) this.watch(this.model.session);
  }

  /** Turns the values of single vertices, stress and temperature, on or off. */
  inspect(on: boolean): void {
    if (on === this.inspecting) return;
    this.inspecting = on;
    if (this.model.session !== null) this.watch(this.model.session);
  }

  async create(params: { scene?: string; definition?: Scene; name?: string }): Promise<SessionDescription> {
    const description = await this.during(text.control.creating, this.link.call('session.create', params));
    this.model.putSession(description.summary);
    this.watch(description.summary.session);
    return description;
  }

  async fork(name?: string): Promise<SessionDescription> {
    const params = { ...this.here(), ...(name === undefined || name === '' ? {} : { name }) };
    const description = await this.during(text.control.copying, this.link.call('session.fork', params));
    this.model.putSession(description.summary);
    this.watch(description.summary.session);
    return description;
  }

  async destroy(session: string): Promise<void> {
    await this.link.call('session.destroy', { session });
    this.left(session);
  }

  async rewind(tick: number): Promise<void> {
    const step = this.model.summary?.step_s ?? 0;
    await this.during(text.control.rewinding(`${(tick * step).toFixed(2)} s`), this.link.call('session.rewind', { ...this.here(), tick }));
    await this.loadTimeline();
  }

  /** Shows a past tick in the picture; the session is not rewound. */
  async lookAt(tick: number): Promise<void> {
    await this.link.past(this.here().session, tick);
  }

  /** Shows the newest state again, and cancels the loading of a past view. */
  lookAtPresent(): void {
    this.link.present();
    if (this.model.session === null || this.model.link.state !== 'online') return;
    this.link.call('session.frame_cancel', this.here()).catch(() => undefined); // there was no past view to cancel
  }

  async reset(): Promise<void> {
    await this.during(text.control.resetting, this.link.call('session.reset', this.here()));
  }

  async restore(name: string): Promise<number> {
    const { tick } = await this.during(text.control.restoring(name), this.link.call('session.restore', { ...this.here(), name }));
    return tick;
  }

  async loadTimeline(): Promise<void> {
    if (this.model.session === null) return;
    this.model.setTimeline(await this.link.call('session.timeline', this.here()));
  }

  async setMaterial(params: MaterialSet): Promise<void> {
    await this.link.call('material.set', { ...params, ...this.here() });
    await this.describe();
  }

  async addTool(tool: Tool): Promise<void> {
    await this.link.call('tool.add', { ...tool, ...this.here() });
    this.model.selectedTool = tool.name;
    await this.describe();
  }

  async removeTool(tool: string): Promise<void> {
    await this.link.call('tool.remove', { ...this.here(), tool });
    await this.describe();
  }

  async configureTool(tool: Tool): Promise<void> {
    const { name, ...definition } = tool;
    delete definition.position_m; // the pose stays as it is
    delete definition.rotation;
    await this.link.call('tool.configure', { ...definition, ...this.here(), tool: name });
    await this.describe();
  }

  async becomeInstrument(wanted: ToolConfigure): Promise<void> {
    await this.link.call('tool.configure', { ...wanted, ...this.here() });
    await this.describe();
  }

  /** Takes a tool without a driver, or as admin any tool; otherwise asks its driver. */
  async takeOver(tool: string): Promise<'taken' | 'asked'> {
    const driver = this.model.drivers.get(tool);
    if (driver && driver.client !== 0 && this.model.hello?.role !== 'admin') {
      await this.link.call('tool.request_takeover', { ...this.here(), tool });
      return 'asked';
    }
    this.model.setDriver(await this.link.call('tool.take_over', { ...this.here(), tool }));
    return 'taken';
  }

  async ask(tool: string): Promise<void> {
    await this.link.call('tool.request_takeover', { ...this.here(), tool });
  }

  async handOver(tool: string, client?: number): Promise<void> {
    const params = { ...this.here(), tool, ...(client === undefined ? {} : { client }) };
    this.model.setDriver(await this.link.call('tool.hand_over', params));
  }

  /** Sends a request about the watched session. */
  call<M extends keyof Requests>(method: M, params: Requests[M]['params']): Promise<Requests[M]['result']> {
    return this.link.call(method, { ...params, ...this.here() });
  }

  async describe(): Promise<void> {
    if (this.model.session === null) return;
    const description = await this.link.call('session.describe', this.here());
    const { joined } = this.model;
    if (!joined || joined.description.summary.session !== description.summary.session) return;
    joined.description = description;
    this.model.setTools(description.definition.tools ?? [], description.drivers);
  }

  push<M extends keyof Pushes>(method: M, params: Pushes[M]): void {
    const handle = this.pushes[method] as (params: Pushes[M]) => void;
    handle(params);
  }

  here(): { session: string } {
    if (this.model.session === null) throw new Error(text.control.noSession);
    return { session: this.model.session };
  }

  private readonly pushes: { [M in keyof Pushes]: (params: Pushes[M]) => void } = {
    'session.changed': (params) => this.sessionChanged(params),
    'session.faulted': ({ session, reason }) => {
      if (session === this.model.session)
        this.model.notice('error', text.control.faulted(reason));
    },
    'tool.driver_changed': ({ session, driver }) => {
      if (session !== this.model.session) return;
      const drove = this.model.drives(driver.tool);
      this.model.setDriver(driver);
      if (drove && driver.client !== 0 && !this.model.drives(driver.tool)) this.model.say('info', text.control.takenOver(nameOf(driver), driver.tool));
    },
    'tool.refused': ({ tool, reason }) => this.model.say('warning', text.control.refused(tool, reason)),
    'takeover.requested': (params) => this.model.setTakeover(params),
    'session.frame_progress': (params) => {
      if (params.session === this.model.session) this.model.emit('looking', params);
    },
    'event': (params) => {
      if (params.session !== this.model.session) return;
      this.model.addEvent(params);
      const doubt = doubtOf(params.event);
      if (doubt) this.model.say('warning', doubt);
    },
  };

  private sessionChanged({ change, summary }: Pushes['session.changed']): void {
    if (change === 'destroyed') {
      this.model.removeSession(summary.session);
      this.left(summary.session);
      return;
    }
    if (change === 'moved') { // the page follows the session: see main.ts
      this.model.removeSession(summary.session);
      return;
    }
    this.model.putSession(summary);
    if (summary.session !== this.model.session) return;
    if (['reset', 'rewound', 'restored', 'restarted'].includes(change)) this.later(this.loadTimeline());
    if (['tools', 'tissue', 'reset', 'rewound', 'restored'].includes(change)) this.later(this.describe());
  }

  private left(session: string): void {
    if (session !== this.model.session) return;
    this.model.notice('info', text.control.ended(session));
    this.watch(this.model.sessions.find((other) => other.session !== session)?.session ?? null);
  }

  private async during<T>(words: string, work: Promise<T>): Promise<T> {
    this.busy.push(words);
    try {
      return await work;
    } finally {
      this.busy.splice(this.busy.indexOf(words), 1);
    }
  }

  /** Runs a follow-up request. If it fails, the next change repeats it. */
  private later(work: Promise<void>): void {
    work.catch((error: unknown) => this.model.notice('warning', errorWords(error)));
  }
}
