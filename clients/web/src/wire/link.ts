// SPDX-License-Identifier: GPL-3.0-or-later
// The interface of the page to the worker: calls with answers, and events.
import type { ShownScalar } from '../model/tissue';
import type { LinkState } from './connection';
import { RpcError } from './connection';
import type { Notices, Pushes, Requests, UploadResult } from './messages.gen';
import type { Channels, Frame, FrameBuffers, FromWorker, Joined, ToWorker, VertexState } from './worker_messages';

export interface LinkEvents {
  state(state: LinkState): void;
  joined(joined: Joined): void;
  notJoined(session: string, message: string): void;
  /** The session has moved. `url` is the address of its daemon; empty if the same address leads there. */
  moved(session: string, to: string, url: string): void;
  frame(frame: Frame): void;
  push<M extends keyof Pushes>(method: M, params: Pushes[M]): void;
  file(name: string, mediaType: string, bytes: Uint8Array<ArrayBuffer>, sound: boolean): void;
}

interface Call {
  resolve(result: unknown): void;
  reject(error: Error): void;
  progress?: (sent: number, total: number) => void;
}

/** Returns a new identity that no other connection has. */
export function newClientId(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(12)), (b) => b.toString(16).padStart(2, '0')).join('');
}

export class Link {
  private readonly worker: Worker;
  private readonly calls = new Map<number, Call>();
  private nextCall = 1;

  constructor(private readonly events: LinkEvents) {
    this.worker = new Worker(new URL('./worker.ts', import.meta.url), { type: 'module' });
    this.worker.onmessage = (event: MessageEvent<FromWorker>) => this.receive(event.data);
  }

  /** Opens a new connection with a new identity, because it does not need answers of an earlier connection. */
  connect(url: string, client: string, token?: string): void {
    this.send({ type: 'connect', url, client, clientId: newClientId(), ...(token === undefined ? {} : { token }) });
  }

  /** Follows a session to another daemon, as the same client. */
  follow(url: string): void {
    this.send({ type: 'follow', url });
  }

  call<M extends keyof Requests>(method: M, params: Requests[M]['params']): Promise<Requests[M]['result']> {
    if (method === 'tool.energize') this.heartbeat(true); // the clock in the heartbeat shows how fresh the request is
    return new Promise((resolve, reject) => {
      const call = this.remember({ resolve: resolve, reject });
      this.send({ type: 'call', call, method, params });
    });
  }

  notify<M extends keyof Notices>(method: M, params: Notices[M]): void {
    this.send({ type: 'notice', method, params });
  }

  heartbeat(visible: boolean): void {
    this.send({ type: 'heartbeat', visible, atUs: Math.round(1000 * (performance.timeOrigin + performance.now())) });
  }

  watch(session: string | null, channels: Channels, scalar: ShownScalar): void {
    this.send({ type: 'watch', session, channels, scalar });
  }

  inspect(vertex: number): Promise<VertexState | null> {
    return new Promise((resolve, reject) => {
      this.send({ type: 'inspect', call: this.remember({ resolve: resolve, reject }), vertex });
    });
  }

  /** Shows a past tick instead of the newest, when the daemon has sent it. The session is not rewound. */
  past(session: string, tick: number): Promise<unknown> {
    return new Promise((resolve, reject) => this.send({ type: 'past', call: this.remember({ resolve, reject }), session, tick }));
  }

  /** Shows the newest state again. */
  present(): void {
    this.send({ type: 'present' });
  }

  upload(name: string, file: File, progress: (sent: number, total: number) => void): Promise<UploadResult> {
    return file.arrayBuffer().then(
      (bytes) =>
        new Promise((resolve, reject) => {
          const call = this.remember({ resolve: resolve, reject, progress });
          this.send({ type: 'upload', call, name, fileName: file.name, bytes }, [bytes]);
        }),
    );
  }

  /** Returns the arrays of a frame to the worker, which answers with the next frame. */
  giveBack(buffers: FrameBuffers): void {
    const { position, normal, burn } = buffers;
    this.send({ type: 'return', buffers }, [position.buffer, normal.buffer, burn.buffer]);
  }

  private remember(call: Call): number {
    this.calls.set(this.nextCall, call);
    return this.nextCall++;
  }

  private send(message: ToWorker, transfer: Transferable[] = []): void {
    this.worker.postMessage(message, transfer);
  }

  private take(call: number): Call | undefined {
    const found = this.calls.get(call);
    this.calls.delete(call);
    return found;
  }

  private receive(message: FromWorker): void {
    const { events } = this;
    switch (message.type) {
      case 'link':
        events.state(message.state);
        break;
      case 'answer':
        this.take(message.call)?.resolve(message.result);
        break;
      case 'failure':
        this.take(message.call)?.reject(new RpcError(message.status, message.message, message.path));
        break;
      case 'push':
        events.push(message.method, message.params);
        break;
      case 'joined':
        events.joined(message.joined);
        break;
      case 'not_joined':
        events.notJoined(message.session, message.message);
        break;
      case 'moved':
        events.moved(message.session, message.to, message.url);
        break;
      case 'frame':
        events.frame(message.frame);
        break;
      case 'progress':
        this.calls.get(message.call)?.progress?.(message.sent, message.total);
        break;
      case 'file':
        events.file(message.name, message.mediaType, message.bytes, message.sound);
        break;
    }
  }
}
