// SPDX-License-Identifier: GPL-3.0-or-later
// A stream at exactly its rate, whatever the machine's load: frames of a real session are recorded as
// the daemon makes them, and played to a page by a door in front of the daemon. Everything else that the
// page says goes to the daemon and back.
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

export type Command = (tick: number, call: (method: string, params: object) => void) => void;

/** Joins a session and keeps its frames until so many ticks are over; `steer` is asked after each frame. A tick
 * has more than one where tools are moved between two. */
export async function record(daemonUrl: string, session: string, ticks: number, steer: Command): Promise<Recording> {
  const socket = await MessageSocket.connect(new URL('v1', daemonUrl), PROTOCOL);
  const frames: Buffer[] = [];
  let id = 0;
  let end: number | null = null;
  const call = (method: string, params: object): void =>
    socket.sendText(JSON.stringify({ jsonrpc: '2.0', id: ++id, method, params }));
  await new Promise<void>((resolve, reject) => {
    socket.onClose = () => reject(new Error('the daemon closed the recording'));
    socket.onText = (text) => {
      const { error } = JSON.parse(text) as { error?: { message: string } };
      if (error) reject(new Error(`${error.message}: ${text}`));
    };
    socket.onBinary = (frame) => {
      const tick = Number(frame.readBigUInt64LE(TICK_AT));
      frames.push(frame);
      end ??= tick + ticks;
      if (tick >= end && frames.length > 1) resolve();
      if (frames.length % ACK_FRAMES === 0) {
        const epoch = frame.readBigUInt64LE(16).toString(16).padStart(16, '0');
        const params = { session, epoch, sequence: Number(frame.readBigUInt64LE(24)) };
        socket.sendText(JSON.stringify({ jsonrpc: '2.0', method: 'stream.ack', params }));
      }
      steer(tick, call);
    };
    call('hello', { version: 1, client: 'recorder' });
    const channels = ['positions', 'mask', 'exposure', 'charring', 'tools', 'statistics'];
    call('session.join', { session, channels });
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
