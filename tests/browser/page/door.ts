// SPDX-License-Identifier: GPL-3.0-or-later
// A proxy ("door") in front of a daemon. All messages between pages and the daemon pass through it. A test can read
// them, and can hold them until it releases them.
import { once } from 'node:events';
import { createServer, request, type IncomingMessage, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import type { Duplex } from 'node:stream';

import { MessageSocket } from './socket';

export const PROTOCOL = 'cautery.v1';

/** A message of the daemon on its way to a page: the answer to `method`, or a notification if `method` is null. */
export interface Said {
  page: MessageSocket;
  text: string;
  method: string | null;
}

export class Door {
  /** methods that pages called, in order */
  readonly asked: string[] = [];
  private readonly server = createServer((asked, answer) => this.serve(asked, answer));
  private readonly sockets = new Set<MessageSocket>();

  constructor(private readonly daemonUrl: string) {
    this.server.on('upgrade', (asked: IncomingMessage, stream: Duplex) => void this.upgrade(asked, stream));
  }

  async start(): Promise<string> {
    this.server.listen(0, '127.0.0.1');
    await once(this.server, 'listening');
    return `http://127.0.0.1:${(this.server.address() as AddressInfo).port}/`;
  }

  async end(): Promise<void> {
    for (const socket of this.sockets) socket.close();
    this.server.closeAllConnections();
    this.server.close();
    await once(this.server, 'close');
  }

  /** Called for each call or notification of a page, as it arrives here. */
  heard: ((method: string, params: Readonly<Record<string, unknown>>) => void) | null = null;

  /** Changes the daemon's messages to pages. */
  change: ((text: string) => string) | null = null;

  protected text({ page, text }: Said): void {
    page.sendText(text);
  }

  /** Passes on a frame, or a piece of a file, to a page. */
  protected binary(page: MessageSocket, bytes: Buffer): void {
    page.sendBinary(bytes);
  }

  private serve(asked: IncomingMessage, answer: ServerResponse): void {
    const headers = { ...asked.headers, host: new URL(this.daemonUrl).host };
    delete headers.origin; // this is the proxy's origin, not the daemon's
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
      const { id, method, params } = JSON.parse(text) as { id?: number; method: string; params: Record<string, unknown> };
      this.asked.push(method);
      this.heard?.(method, params);
      if (id !== undefined) names.set(id, method);
      daemon.sendText(text);
    };
    page.onBinary = (bytes) => daemon.sendBinary(bytes);
    page.onClose = () => daemon.close();
    daemon.onClose = () => page.close();
    daemon.onText = (text) => {
      const { id } = JSON.parse(text) as { id?: number };
      this.text({ page, text: this.change?.(text) ?? text, method: id === undefined ? null : (names.get(id) ?? null) });
    };
    daemon.onBinary = (bytes) => this.binary(page, bytes);
  }
}

/** Holds answers to one method, or frames. All other messages pass. */
export class HoldingDoor extends Door {
  private held: string | null = null;
  private readonly waiting: (() => void)[] = [];

  /** From now on, holds answers to the method `what`, or frames if `what` is "frames". */
  hold(what: string): void {
    this.held = what;
  }

  /** Releases the first held message, once there is one. The other messages stay. */
  async letOnePass(): Promise<void> {
    while (this.waiting.length === 0) await new Promise(setImmediate);
    this.waiting.shift()!();
  }

  letGo(): void {
    this.held = null;
    for (const pass of this.waiting.splice(0)) pass();
  }

  protected override text({ page, text, method }: Said): void {
    this.pass(method !== null && method === this.held, () => page.sendText(text));
  }

  protected override binary(page: MessageSocket, bytes: Buffer): void {
    this.pass(this.held === 'frames', () => page.sendBinary(bytes));
  }

  private pass(held: boolean, go: () => void): void {
    if (held) this.waiting.push(go);
    else go();
  }
}
