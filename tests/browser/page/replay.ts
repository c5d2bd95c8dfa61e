// SPDX-License-Identifier: GPL-3.0-or-later
// A stream at exactly its rate, whatever the machine's load: frames of a real session are recorded as
// the daemon makes them, and played to a page by a door in front of the daemon. Everything else that the
// page says goes to the daemon and back.
import { setTimeout as delay } from 'node:timers/promises';

import { Door, PROTOCOL, type Said } from './door';
import { MessageSocket } from './socket';

const PUBLISHED_AT = 56; // offset of published_us in a frame's header
const TICK_AT = 40;
const KIND_AT = 5;
const DELTA = 2;
const ACK_FRAMES = 6;
const LOOK_MS = 2;

export interface Recording {
  session: string;
  /** the topology, then a key frame, then deltas */
  frames: Buffer[];
}

export type Command = (step: number, call: (method: string, params: object) => void) => void;

/** Joins a session, pauses it and keeps its frames while it takes so many steps, one by one: `steer` speaks before
 * each, so that the same cut comes of it whatever the machine's load. A tick has more than one frame where tools
 * are moved between two. */
export async function record(daemonUrl: string, session: string, steps: number, steer: Command): Promise<Recording> {
  const socket = await MessageSocket.connect(new URL('v1', daemonUrl), PROTOCOL);
  const frames: Buffer[] = [];
  const answers = new Map<number, { resolve(result: unknown): void; reject(error: Error): void }>();
  let id = 0;
  const call = (method: string, params: object): Promise<unknown> =>
    new Promise((resolve, reject) => {
      answers.set(++id, { resolve, reject });
      socket.sendText(JSON.stringify({ jsonrpc: '2.0', id, method, params }));
    });
  socket.onText = (text) => {
    const { id: of, result, error } = JSON.parse(text) as { id?: number; result?: unknown; error?: { message: string } };
    if (of === undefined) return;
    if (error) answers.get(of)?.reject(new Error(`${error.message}: ${text}`));
    else answers.get(of)?.resolve(result);
    answers.delete(of);
  };
  let look = (): void => undefined; // at each frame
  socket.onBinary = (frame) => {
    frames.push(frame);
    if (frames.length % ACK_FRAMES === 0) {
      const epoch = frame.readBigUInt64LE(16).toString(16).padStart(16, '0');
      const params = { session, epoch, sequence: Number(frame.readBigUInt64LE(24)) };
      socket.sendText(JSON.stringify({ jsonrpc: '2.0', method: 'stream.ack', params }));
    }
    look();
  };
  const until = (enough: () => boolean): Promise<void> =>
    new Promise((resolve) => {
      look = (): void => {
        if (enough()) resolve();
      };
      look();
    });
  const take = async (): Promise<void> => {
    await call('hello', { version: 1, client: 'recorder' });
    const there = async (): Promise<boolean> =>
      ((await call('session.list', {})) as { sessions: { session: string }[] }).sessions.some((one) => one.session === session);
    while (!(await there())) await delay(LOOK_MS); // the demo is still being made
    await call('session.pause', { session });
    const channels = ['positions', 'mask', 'exposure', 'charring', 'tools', 'statistics'];
    await call('session.join', { session, channels });
    await until(() => frames.length === 2);
    let tick = 0;
    for (let step = 0; step < steps; step++) {
      const said: Promise<unknown>[] = [];
      steer(step, (method, params) => void said.push(call(method, params)));
      const stepped = call('session.step', { session, ticks: 1 });
      await Promise.all(said);
      tick = ((await stepped) as { tick: number }).tick;
    }
    await until(() => Number(frames[frames.length - 1].readBigUInt64LE(TICK_AT)) === tick);
  };
  await new Promise<void>((resolve, reject) => {
    socket.onClose = () => reject(new Error('the daemon closed the recording'));
    take().then(resolve, reject);
  });
  socket.onClose = () => undefined;
  socket.close();
  const deltas = frames.slice(2);
  if (deltas.some((frame) => frame[KIND_AT] !== DELTA)) throw new Error('the recording has a gap');
  return { session, frames };
}

export class Replay extends Door {
  /** deltas sent so far, and the tick of the last */
  sent = 0;
  readonly lastTick: number;
  private timer: NodeJS.Timeout | undefined;
  private clockUs = 0; // the daemon's clock when this one stood at 0

  constructor(
    daemonUrl: string,
    private readonly recording: Recording,
    private readonly rateHz: number,
  ) {
    super(daemonUrl);
    this.lastTick = Number(recording.frames[recording.frames.length - 1].readBigUInt64LE(TICK_AT));
  }

  override async end(): Promise<void> {
    clearInterval(this.timer);
    await super.end();
  }

  protected override text({ page, text, method }: Said): void {
    super.text({ page, text, method });
    const { result } = JSON.parse(text) as { result?: { server_time_us?: number } };
    if (method === 'hello') this.clockUs = (result?.server_time_us ?? 0) - 1000 * performance.now();
    if (method === 'session.join') this.play(page);
  }

  /** The daemon's own frames stay out: the session is paused, and the page sees the recording. */
  protected override binary(): void {}

  private play(page: MessageSocket): void {
    const [topology, key, ...deltas] = this.recording.frames;
    const send = (frame: Buffer): void => {
      frame.writeBigUInt64LE(BigInt(Math.round(this.clockUs + 1000 * performance.now())), PUBLISHED_AT);
      page.sendBinary(frame);
    };
    send(topology);
    send(key);
    const started = performance.now();
    this.timer = setInterval(() => {
      const due = Math.min(Math.floor(((performance.now() - started) * this.rateHz) / 1000), deltas.length);
      while (this.sent < due) send(deltas[this.sent++]);
      if (this.sent === deltas.length) clearInterval(this.timer);
    }, LOOK_MS);
  }
}
