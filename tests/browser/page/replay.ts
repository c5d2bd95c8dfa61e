// SPDX-License-Identifier: GPL-3.0-or-later
// A stream at exactly its rate, whatever the machine's load: frames of a real session are recorded as
// the daemon makes them, and played to a page by a door in front of the daemon. Everything else that the
// page says goes to the daemon and back.
import { once } from 'node:events';
import { createServer, request, type IncomingMessage, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import type { Duplex } from 'node:stream';

import { MessageSocket } from './socket';

const PROTOCOL = 'cautery.v1';
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

/** Joins a session and keeps its frames until there are `count` deltas; `steer` is asked after each. */
export async function record(daemonUrl: string, session: string, count: number, steer: Command): Promise<Recording> {
  const socket = await MessageSocket.connect(new URL('v1', daemonUrl), PROTOCOL);
  const frames: Buffer[] = [];
  let id = 0;
  const call = (method: string, params: object): void =>
    socket.sendText(JSON.stringify({ jsonrpc: '2.0', id: ++id, method, params }));
  await new Promise<void>((resolve, reject) => {
    socket.onClose = () => reject(new Error('the daemon closed the recording'));
    socket.onText = (text) => {
      const { error } = JSON.parse(text) as { error?: { message: string } };
      if (error) reject(new Error(`${error.message}: ${text}`));
    };
    socket.onBinary = (frame) => {
      frames.push(frame);
      if (frames.length >= count + 2) resolve();
      if (frames.length % ACK_FRAMES === 0) {
        const epoch = frame.readBigUInt64LE(16).toString(16).padStart(16, '0');
        const params = { session, epoch, sequence: Number(frame.readBigUInt64LE(24)) };
        socket.sendText(JSON.stringify({ jsonrpc: '2.0', method: 'stream.ack', params }));
      }
      steer(Number(frame.readBigUInt64LE(TICK_AT)), call);
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

export class Replay {
  /** deltas sent so far, and the tick of the last */
  sent = 0;
  readonly lastTick: number;
  /** methods that the page called, in order */
  readonly asked: string[] = [];
  private readonly server = createServer((asked, answer) => this.serve(asked, answer));
  private readonly sockets = new Set<MessageSocket>();
  private timer: NodeJS.Timeout | undefined;
  private clockUs = 0; // the daemon's clock when this one stood at 0

  constructor(
    private readonly daemonUrl: string,
    private readonly recording: Recording,
    private readonly rateHz: number,
  ) {
    this.lastTick = Number(recording.frames[recording.frames.length - 1].readBigUInt64LE(TICK_AT));
    this.server.on('upgrade', (asked: IncomingMessage, stream: Duplex) => void this.upgrade(asked, stream));
  }

  async start(): Promise<string> {
    this.server.listen(0, '127.0.0.1');
    await once(this.server, 'listening');
    return `http://127.0.0.1:${(this.server.address() as AddressInfo).port}/`;
  }

  async end(): Promise<void> {
    clearInterval(this.timer);
    for (const socket of this.sockets) socket.close();
    this.server.closeAllConnections();
    this.server.close();
    await once(this.server, 'close');
  }

  private serve(asked: IncomingMessage, answer: ServerResponse): void {
    const headers = { ...asked.headers, host: new URL(this.daemonUrl).host };
    delete headers.origin; // the door's, which is not the daemon's
    const onwards = request(new URL(asked.url ?? '/', this.daemonUrl), { method: asked.method ?? 'GET', headers }, (got) => {
      answer.writeHead(got.statusCode ?? 502, got.headers);
      got.pipe(answer);
    });
    onwards.on('error', () => answer.destroy());
    onwards.end();
  }

  private async upgrade(asked: IncomingMessage, stream: Duplex): Promise<void> {
    const daemon = await MessageSocket.connect(new URL(asked.url ?? '/v1', this.daemonUrl), PROTOCOL);
    const page = MessageSocket.accept(asked, stream);
    for (const socket of [page, daemon]) this.sockets.add(socket);
    const names = new Map<number, string>();
    page.onText = (text) => {
      const { id, method } = JSON.parse(text) as { id?: number; method: string };
      this.asked.push(method);
      if (id !== undefined) names.set(id, method);
      daemon.sendText(text);
    };
    page.onBinary = (bytes) => daemon.sendBinary(bytes);
    page.onClose = () => daemon.close();
    daemon.onClose = () => page.close();
    daemon.onText = (text) => {
      page.sendText(text);
      const { id, result } = JSON.parse(text) as { id?: number; result?: { server_time_us?: number } };
      const method = id === undefined ? undefined : names.get(id);
      if (method === 'hello') this.clockUs = (result?.server_time_us ?? 0) - 1000 * performance.now();
      if (method === 'session.join') this.play(page);
    };
    // The daemon's own frames stay out: the session is paused, and the page sees the recording.
  }

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
