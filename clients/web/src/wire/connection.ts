// SPDX-License-Identifier: Apache-2.0
// One lasting connection to a daemon, with hello, requests and answers. After a loss it connects again with back-off, the
// same client identity and the resume token. It uses no page: the caller creates the sockets.
import { CHANGING_METHODS, CLOSE_REASONS, SUBPROTOCOL, WIRE_VERSION } from './messages.gen';
import type { HelloResult, Notices, Pushes, Requests } from './messages.gen';

export interface Socket {
  binaryType: BinaryType;
  send(data: string | ArrayBufferView<ArrayBuffer>): void;
  close(): void;
  onopen: ((event: Event) => void) | null;
  onclose: ((event: CloseEvent) => void) | null;
  onmessage: ((event: MessageEvent) => void) | null;
}

export interface ConnectionOptions {
  url: string;
  client: string;
  clientId: string;
  token?: string;
}

export type LinkState =
  | { state: 'connecting' }
  | { state: 'online'; hello: HelloResult; again: boolean }
  | { state: 'lost'; words: string; retryInS: number }
  | { state: 'refused'; words: string; status: 'version' | 'unauthorized' | 'replaced' };

export interface ConnectionEvents {
  state(state: LinkState): void;
  push<M extends keyof Pushes>(method: M, params: Pushes[M]): void;
  binary(bytes: Uint8Array): void;
}

/** An error answer, with the message of the server; `path` is the wrong member. */
export class RpcError extends Error {
  constructor(
    readonly status: string,
    message: string,
    readonly path?: string,
    readonly reason?: string,
    /** for status moved: the new id of the session, and the address of its daemon if that is another */
    readonly movedTo?: string,
    readonly url?: string,
  ) {
    super(reason ?? message);
  }
}

interface Pending {
  method: string;
  text: string;
  resolve(result: unknown): void;
  reject(error: Error): void;
}

interface Answer {
  id?: number | null;
  method?: keyof Pushes;
  params?: never;
  result?: unknown;
  error?: { message: string; data?: { status?: string; path?: string; reason?: string; moved_to?: string; url?: string } };
}

const FIRST_RETRY_S = 0.25;
const LONGEST_RETRY_S = 8;
const REFUSALS: Readonly<Record<number, 'version' | 'unauthorized' | 'replaced'>> = {
  4002: 'unauthorized',
  4003: 'version',
  4007: 'replaced',
};

/** Whether a request is sent again after a loss. Commands to a tool are not, because they are meant for their moment. */
function outlivesLoss(method: string): boolean {
  return !method.startsWith('tool.') && !method.startsWith('upload.') && !method.startsWith('stream.') && method !== 'heartbeat';
}

export class Connection {
  private socket: Socket | null = null;
  private hello: HelloResult | null = null;
  private pending = new Map<number, Pending>();
  private nextId = 1;
  private clientSequence = 0;
  private retries = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private url: string;
  /** resume token of the daemon that had the session, until the session is found on its new daemon */
  private keptResume: string | null = null;
  private following = false;

  constructor(
    private readonly options: ConnectionOptions,
    private readonly open: (url: string, protocol: string) => Socket,
    private readonly events: ConnectionEvents,
  ) {
    this.url = options.url;
  }

  start(): void {
    this.events.state({ state: 'connecting' });
    const socket = this.open(this.url, SUBPROTOCOL);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onopen = () => this.greet();
    socket.onmessage = (event) => this.receive(event.data as string | ArrayBuffer);
    socket.onclose = (event) => this.closed(event);
  }

  /** Ends the connection for good. */
  stop(): void {
    clearTimeout(this.timer);
    const { socket } = this;
    this.socket = null;
    if (socket) {
      socket.onclose = null;
      socket.close();
    }
    this.abandon(() => true, 'the connection was closed');
  }

  /** Follows a session to another daemon, as the same client, which gets its tools back there. */
  follow(url: string): void {
    this.url = url;
    this.keptResume ??= this.lastResume;
    this.following = true;
    this.comeBack();
  }

  /** Closes the socket and connects again, as after a loss. */
  comeBack(): void {
    const { socket } = this;
    if (!socket) return; // a new connection is already planned
    socket.onclose = null;
    socket.onmessage = null;
    socket.close();
    this.lost('the session has moved to another server');
  }

  /** Notes that the followed session was found. */
  found(): void {
    this.keptResume = null;
    this.following = false;
    this.retries = 0;
  }

  get online(): boolean {
    return this.hello !== null;
  }

  request<M extends keyof Requests>(method: M, params: Requests[M]['params']): Promise<Requests[M]['result']> {
    return new Promise((resolve, reject) => {
      const id = this.nextId++;
      const sequenced = CHANGING_METHODS.has(method) ? { ...params, client_sequence: ++this.clientSequence } : params;
      const text = JSON.stringify({ jsonrpc: '2.0', id, method, params: sequenced });
      if (!this.online && method !== 'hello' && !outlivesLoss(method)) {
        reject(new RpcError('lost', 'the server cannot be reached at the moment'));
        return;
      }
      this.pending.set(id, { method, text, resolve: resolve, reject });
      if (this.online || method === 'hello') this.socket?.send(text);
    });
  }

  notify<M extends keyof Notices>(method: M, params: Notices[M]): void {
    if (this.online) this.socket?.send(JSON.stringify({ jsonrpc: '2.0', method, params }));
  }

  sendBytes(bytes: Uint8Array<ArrayBuffer>): void {
    if (this.online) this.socket?.send(bytes);
  }

  private greet(): void {
    const { client, clientId, token } = this.options;
    const resume = this.keptResume ?? this.lastResume;
    const params = {
      version: WIRE_VERSION,
      client,
      client_id: clientId,
      ...(token === undefined ? {} : { token }),
      ...(resume === null ? {} : { resume }),
    };
    this.request('hello', params).then(
      (hello) => this.greeted(hello),
      (error: unknown) => this.refused(error),
    );
  }

  private lastResume: string | null = null;

  private greeted(hello: HelloResult): void {
    const again = this.lastResume !== null;
    this.hello = hello;
    this.lastResume = hello.resume;
    if (!this.following) this.retries = 0;
    for (const pending of this.pending.values()) this.socket?.send(pending.text);
    this.events.state({ state: 'online', hello, again });
  }

  private refused(error: unknown): void {
    if (!(error instanceof RpcError)) return;
    const status = error.status === 'version' ? 'version' : error.status === 'unauthorized' ? 'unauthorized' : null;
    if (status) this.end(status, error.message);
  }

  private end(status: 'version' | 'unauthorized' | 'replaced', words: string): void {
    this.stop();
    const versions = `This page and the server have different versions (this page: ${WIRE_VERSION}). Reload the page. If that does not help, update the server.`;
    this.events.state({ state: 'refused', status, words: status === 'version' ? versions : words });
  }

  private receive(data: string | ArrayBuffer): void {
    if (typeof data !== 'string') {
      this.events.binary(new Uint8Array(data));
      return;
    }
    const answer = JSON.parse(data) as Answer;
    if (answer.method !== undefined) {
      this.events.push(answer.method, answer.params as never);
      return;
    }
    const pending = this.pending.get(answer.id ?? -1);
    if (!pending) return;
    this.pending.delete(answer.id ?? -1);
    if (answer.error) {
      const { message, data: detail } = answer.error;
      pending.reject(new RpcError(detail?.status ?? 'internal', message, detail?.path, detail?.reason, detail?.moved_to, detail?.url));
    } else {
      pending.resolve(answer.result);
    }
  }

  private closed(event: CloseEvent): void {
    this.socket = null;
    this.hello = null;
    const words = CLOSE_REASONS[event.code] ?? (event.reason || 'the server cannot be reached');
    const refusal = REFUSALS[event.code];
    if (refusal) {
      this.end(refusal, words);
      return;
    }
    this.lost(words);
  }

  private lost(words: string): void {
    this.socket = null;
    this.hello = null;
    this.abandon((method) => method === 'hello' || !outlivesLoss(method), 'the connection was lost');
    const retryInS = this.following && this.retries === 0 ? 0 : Math.min(LONGEST_RETRY_S, FIRST_RETRY_S * 2 ** this.retries) * (0.75 + 0.5 * Math.random());
    this.retries++;
    this.events.state({ state: 'lost', words, retryInS });
    this.timer = setTimeout(() => this.start(), retryInS * 1000);
  }

  private abandon(which: (method: string) => boolean, words: string): void {
    for (const [id, pending] of this.pending) {
      if (!which(pending.method)) continue;
      this.pending.delete(id);
      pending.reject(new RpcError('lost', words));
    }
  }
}
