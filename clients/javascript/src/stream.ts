// SPDX-License-Identifier: Apache-2.0
// A joined session: its constant data, and the newest state.
import { RpcError, type Connection } from '../../web/src/wire/connection';
import type { StreamState } from '../../web/src/wire/decoder';
import type { SessionDescription, SessionJoin, StreamDescription } from '../../web/src/wire/messages.gen';
import { Subscription } from '../../web/src/wire/subscription';
import type { Topology } from '../../web/src/wire/topology';

interface Waiter {
  condition(stream: Stream): boolean;
  resolve(state: StreamState): void;
  reject(error: Error): void;
}

export class Stream {
  session: SessionDescription | null = null;
  description: StreamDescription | null = null;
  topology: Topology | null = null;
  private newest: StreamState | null = null;
  private waiters: Waiter[] = [];
  /** Frames that came before start() handled the answer before them; Node delivers both in one task. */
  private early: Uint8Array[] = [];
  private starting = 0;
  private readonly subscription: Subscription;

  /** Use Client.join to create a stream. */
  constructor(connection: Connection, session: string, options: Omit<SessionJoin, 'session'>) {
    this.subscription = new Subscription(connection, session, options, {
      joined: (description, stream, topology) => Object.assign(this, { session: description, description: stream, topology }),
      frame: (state) => this.show(state),
      failed: (error) => this.end(error instanceof Error ? error : new RpcError('internal', String(error))),
    });
  }

  /** The newest state. Its arrays change with the next frame: copy what you keep. */
  get state(): StreamState {
    if (!this.newest) throw new RpcError('lost', 'no frame has come yet');
    return this.newest;
  }

  /** Returns x, y, z of a vertex, in metres. The position is old if no drawn face uses the vertex. */
  position(vertex: number): [number, number, number] {
    const { quantised } = this.state;
    const { origin_m: origin, step_m: step } = this.description!;
    const at = (axis: number): number => origin[axis]! + step * quantised[3 * vertex + axis]!;
    return [at(0), at(1), at(2)];
  }

  /** Returns whether a face is removed, or not drawn for another reason. */
  isRemoved(face: number): boolean {
    return ((this.state.mask[face >>> 5]! >>> (face & 31)) & 1) === 1;
  }

  /** Resolves with the first state that fulfils the condition, which is checked for each frame. */
  until(condition: (stream: Stream) => boolean): Promise<StreamState> {
    if (this.newest && condition(this)) return Promise.resolve(this.newest);
    return new Promise((resolve, reject) => this.waiters.push({ condition, resolve, reject }));
  }

  // The following functions are for the client only.

  async start(): Promise<void> {
    this.starting++;
    await this.subscription.start();
    this.starting--;
    if (this.starting > 0) return;
    for (const bytes of this.early.splice(0)) this.subscription.take(bytes);
  }

  stop(): void {
    this.subscription.stop();
    this.end(new RpcError('lost', 'the session was left'));
  }

  take(bytes: Uint8Array): void {
    if (this.starting > 0) this.early.push(bytes);
    else this.subscription.take(bytes);
  }

  end(error: Error): void {
    for (const waiter of this.waiters.splice(0)) waiter.reject(error);
  }

  private show(state: StreamState): void {
    this.newest = state;
    const waiting = this.waiters.splice(0);
    for (const waiter of waiting)
      if (waiter.condition(this)) waiter.resolve(state);
      else this.waiters.push(waiter);
  }
}
