// SPDX-License-Identifier: GPL-3.0-or-later
// The frames of a real session as the daemon makes them. The session takes its steps one by one. So the same commands
// give the same frames, whatever the machine's load.
import { setTimeout as delay } from 'node:timers/promises';

import { PROTOCOL } from './door';
import { MessageSocket } from './socket';

const KIND_AT = 5; // offsets in a frame's header
const EPOCH_AT = 16;
const SEQUENCE_AT = 24;
const TICK_AT = 40;
const DELTA = 2;
const ACK_FRAMES = 6;
const LOOK_MS = 10;
const CHANNELS = ['positions', 'mask', 'exposure', 'charring', 'tools', 'statistics'];

export interface Recording {
  session: string;
  /** the topology, then a key frame, then deltas; a tick has several deltas if tools are moved between two steps */
  frames: Buffer[];
}

export type Command = (step: number, call: (method: string, params: object) => void) => void;

export const tickOf = (frame: Buffer): number => Number(frame.readBigUInt64LE(TICK_AT));

class Recorder {
  readonly frames: Buffer[] = [];
  private readonly answers = new Map<number, { resolve(result: unknown): void; reject(error: Error): void }>();
  private last = 0; // id of the last request
  private look = (): void => undefined; // called at each frame

  constructor(
    private readonly socket: MessageSocket,
    private readonly session: string,
  ) {
    socket.onText = (text): void => this.hear(text);
    socket.onBinary = (frame): void => this.keep(frame);
  }

  /** Pauses the session, joins it, and makes it take `steps` steps; `steer` sends its commands before each step. */
  async take(steps: number, steer: Command): Promise<void> {
    const { session } = this;
    await this.call('hello', { version: 1, client: 'recorder' });
    while (!(await this.isThere())) await delay(LOOK_MS); // waits while the daemon still makes the demo
    await this.call('session.pause', { session });
    await this.call('session.join', { session, channels: CHANNELS });
    await this.until(() => this.frames.length === 2);
    let tick = 0;
    for (let step = 0; step < steps; step++) {
      const said: Promise<unknown>[] = [];
      steer(step, (method, params) => void said.push(this.call(method, params)));
      said.push(this.call('session.step', { session, ticks: 1 }));
      tick = ((await Promise.all(said)).pop() as { tick: number }).tick;
    }
    await this.until(() => tickOf(this.frames[this.frames.length - 1]) === tick);
  }

  private call(method: string, params: object): Promise<unknown> {
    return new Promise((resolve, reject) => {
      this.answers.set(++this.last, { resolve, reject });
      this.socket.sendText(JSON.stringify({ jsonrpc: '2.0', id: this.last, method, params }));
    });
  }

  private async isThere(): Promise<boolean> {
    const { sessions } = (await this.call('session.list', {})) as { sessions: { session: string }[] };
    return sessions.some(({ session }) => session === this.session);
  }

  private hear(text: string): void {
    const { id, result, error } = JSON.parse(text) as { id?: number; result?: unknown; error?: { message: string } };
    if (id === undefined) return;
    if (error) this.answers.get(id)?.reject(new Error(`${error.message}: ${text}`));
    else this.answers.get(id)?.resolve(result);
    this.answers.delete(id);
  }

  private keep(frame: Buffer): void {
    this.frames.push(frame);
    if (this.frames.length % ACK_FRAMES === 0) {
      const epoch = frame.readBigUInt64LE(EPOCH_AT).toString(16).padStart(16, '0');
      const params = { session: this.session, epoch, sequence: Number(frame.readBigUInt64LE(SEQUENCE_AT)) };
      this.socket.sendText(JSON.stringify({ jsonrpc: '2.0', method: 'stream.ack', params }));
    }
    this.look();
  }

  private until(enough: () => boolean): Promise<void> {
    return new Promise((resolve) => {
      this.look = (): void => {
        if (enough()) resolve();
      };
      this.look();
    });
  }
}

/** Returns the frames of a session that takes `steps` steps under the commands of `steer`. */
export async function record(daemonUrl: string, session: string, steps: number, steer: Command): Promise<Recording> {
  const socket = await MessageSocket.connect(new URL('v1', daemonUrl), PROTOCOL);
  const recorder = new Recorder(socket, session);
  await new Promise<void>((resolve, reject) => {
    socket.onClose = () => reject(new Error('the daemon closed the recording'));
    recorder.take(steps, steer).then(resolve, reject);
  });
  socket.onClose = () => undefined;
  socket.close();
  const { frames } = recorder;
  if (frames.slice(2).some((frame) => frame[KIND_AT] !== DELTA)) throw new Error('the recording has a gap');
  return { session, frames };
}
