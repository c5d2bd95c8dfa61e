// SPDX-License-Identifier: Apache-2.0
// One connection with its streams and files. After a loss it reconnects by itself and joins its streams again.
import { isChunk, readChunk, type Chunk } from '../../web/src/wire/chunk';
import { Connection, RpcError, type LinkState } from '../../web/src/wire/connection';
import { decoderReady } from '../../web/src/wire/elements';
import { Downloads, upload, type ReceivedFile } from '../../web/src/wire/files';
import type { HelloResult, Notices, Pushes, Requests, SessionJoin, Transfer, UploadResult } from '../../web/src/wire/messages.gen';
import { Stream } from './stream';

export interface ClientOptions {
  /** access token, if the daemon needs one */
  token?: string;
  /** name of this program for the daemon and other clients */
  name?: string;
  /** called for each notification of the daemon */
  notice?: <M extends keyof Pushes>(method: M, params: Pushes[M]) => void;
  /** called when the connection is lost, restored, or refused for good */
  link?: (state: LinkState) => void;
}

/** Methods whose result announces a file in chunks. */
type FileMethod = { [M in keyof Requests]: Requests[M]['result'] extends Transfer ? M : never }[keyof Requests];

export class Client {
  private readonly connection: Connection;
  private readonly streams = new Set<Stream>();
  private readonly downloads = new Downloads(() => undefined);
  private hello: HelloResult | null = null;
  /** Chunks that came before download() handled the answer that announces them. */
  private early: Chunk[] = [];
  private announcing = 0;

  private constructor(
    url: string,
    private readonly options: ClientOptions,
    private readonly opened: (error?: Error) => void,
  ) {
    const address = new URL(url);
    if (address.pathname === '/') address.pathname = '/v1';
    this.connection = new Connection(
      {
        url: address.href,
        client: options.name ?? 'cautery for JavaScript',
        clientId: crypto.randomUUID(),
        ...(options.token === undefined ? {} : { token: options.token }),
      },
      (to, protocol) => new WebSocket(to, protocol),
      {
        state: (state) => this.follow(state),
        push: (method, params) => options.notice?.(method, params),
        binary: (bytes) => this.take(bytes),
      },
    );
    this.connection.start();
  }

  /** `url`: such as ws://127.0.0.1:8740. Rejects if the first connection fails or is refused. */
  static async connect(url: string, options: ClientOptions = {}): Promise<Client> {
    await decoderReady;
    return new Promise((resolve, reject) => {
      const client: Client = new Client(url, options, (error) => {
        if (!error) return resolve(client);
        client.close();
        reject(error);
      });
    });
  }

  /** The answer of the daemon to hello: version, limits, role. */
  get server(): HelloResult {
    if (!this.hello) throw new RpcError('lost', 'the daemon has not answered yet');
    return this.hello;
  }

  /** Sends a request. Rejects with RpcError if the daemon refuses it. */
  call<M extends keyof Requests>(method: M, params: Requests[M]['params']): Promise<Requests[M]['result']> {
    return this.connection.request(method, params);
  }

  /** Sends a notification, which has no answer: tool.move, heartbeat. */
  notify<M extends keyof Notices>(method: M, params: Notices[M]): void {
    this.connection.notify(method, params);
  }

  /** Joins a session. Resolves with the stream after its first state. */
  async join(session: string, options: Omit<SessionJoin, 'session'> = {}): Promise<Stream> {
    const stream = new Stream(this.connection, session, options);
    this.streams.add(stream);
    await stream.start();
    await stream.until(() => true);
    return stream;
  }

  /** Leaves a session; its stream ends. */
  leave(stream: Stream): void {
    this.streams.delete(stream);
    stream.stop();
  }

  async download<M extends FileMethod>(method: M, params: Requests[M]['params']): Promise<ReceivedFile> {
    this.announcing++;
    try {
      const announced: Transfer = await this.connection.request(method, params);
      return await new Promise((resolve) => {
        this.downloads.announce(announced, resolve);
        this.announced();
      });
    } catch (error) {
      this.announced();
      throw error;
    }
  }

  /** Uploads a file. `name` is the name of the upload for session.create and mesh.read. */
  upload(name: string, fileName: string, bytes: Uint8Array<ArrayBuffer>): Promise<UploadResult> {
    return upload(this.connection, name, fileName, bytes, () => undefined);
  }

  /** Ends the connection for good. Energy of the tools that this client drives goes off. */
  close(): void {
    this.connection.stop();
    for (const stream of this.streams) stream.end(new RpcError('lost', 'the connection was closed'));
  }

  private follow(state: LinkState): void {
    this.options.link?.(state);
    if (state.state === 'online') {
      this.hello = state.hello;
      this.opened();
      if (state.again) for (const stream of this.streams) void stream.start();
    } else if (state.state === 'refused' || (state.state === 'lost' && !this.hello)) {
      this.opened(new RpcError(state.state, state.words));
    }
  }

  private announced(): void {
    this.announcing--;
    if (this.announcing > 0) return;
    for (const chunk of this.early.splice(0)) this.downloads.take(chunk);
  }

  private take(bytes: Uint8Array): void {
    if (isChunk(bytes) && this.announcing > 0) this.early.push(readChunk(bytes));
    else if (isChunk(bytes)) this.downloads.take(readChunk(bytes));
    else for (const stream of this.streams) stream.take(bytes);
  }
}
