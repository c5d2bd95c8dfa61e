// SPDX-License-Identifier: Apache-2.0
// The stream of one session: join, topology, frames, acknowledgement, and a key frame after a gap.
import type { Connection } from './connection';
import { FrameDecoder, type Changes, type StreamState } from './decoder';
import { readHeader, WireError } from './header';
import type { SessionDescription, SessionJoin, StreamDescription } from './messages.gen';
import { decodeTopology, type Topology } from './topology';

export type Join = Omit<SessionJoin, 'session'>;

export interface SubscriptionEvents {
  /** What to join a session with, where that depends on what it has. Without it: what was given. */
  ask?(description: SessionDescription, given: Join): Join;
  /** The session is joined: everything that never changes in it. */
  joined(description: SessionDescription, stream: StreamDescription, topology: Topology): void;
  frame(state: StreamState, changes: Changes, byteCount: number): void;
  /** The session cannot be joined, in words. */
  failed(error: unknown): void;
}

const ACK_MS = 100;
const KEY_FRAME_MS = 1000;

export class Subscription {
  private stream: StreamDescription | null = null;
  private description: SessionDescription | null = null;
  private decoder: FrameDecoder | null = null;
  private ready = false;
  private lastAck = 0;
  private lastKeyRequest = -KEY_FRAME_MS;
  private ended = false;
  framesDecoded = 0;
  framesSkipped = 0;
  keyFramesAsked = 0;

  constructor(
    private readonly connection: Connection,
    readonly session: string,
    private join: Join,
    private readonly events: SubscriptionEvents,
    private readonly now: () => number = () => performance.now(),
  ) {}

  /** Joins, or joins again: after a lost connection, or with other channels. */
  async start(join = this.join): Promise<void> {
    this.join = join;
    this.ready = false;
    this.stream = null;
    try {
      const { session } = this;
      this.description = await this.connection.request('session.describe', { session });
      if (this.stopped()) return;
      const asked = this.events.ask?.(this.description, join) ?? join;
      this.stream = await this.connection.request('session.join', { ...asked, session });
      this.decoder = new FrameDecoder(this.stream);
    } catch (error) {
      if (!this.stopped()) this.events.failed(error);
    }
  }

  stop(): void {
    if (this.ended) return;
    this.ended = true;
    const leaving = this.connection.online ? this.connection.request('session.leave', { session: this.session }) : null;
    leaving?.catch(() => undefined); // the session may already be gone, so a failure does not matter
  }

  private stopped(): boolean {
    return this.ended;
  }

  take(bytes: Uint8Array): void {
    const { stream, decoder, description } = this;
    if (this.ended || !stream || !decoder || !description) return;
    try {
      const header = readHeader(bytes);
      if (header.session !== stream.session_number) return;
      if (header.kind === 'topology') {
        this.events.joined(description, stream, decodeTopology(stream, bytes));
        this.ready = true;
        return;
      }
      this.takeFrame(decoder, bytes);
    } catch (error) {
      if (!(error instanceof WireError)) throw error;
      this.framesSkipped++;
      this.askKeyFrame();
    }
  }

  private takeFrame(decoder: FrameDecoder, bytes: Uint8Array): void {
    if (!this.ready) return;
    const outcome = decoder.decode(bytes);
    if (outcome.kind === 'skipped') {
      this.framesSkipped++;
      if (outcome.gap) this.askKeyFrame();
      return;
    }
    this.framesDecoded++;
    this.events.frame(decoder.state, outcome.changes, bytes.byteLength);
    this.acknowledge(decoder.state);
  }

  private acknowledge(state: StreamState): void {
    const now = this.now();
    if (now - this.lastAck < ACK_MS) return;
    this.lastAck = now;
    const epoch = state.epoch.toString(16).padStart(16, '0');
    this.connection.notify('stream.ack', { session: this.session, epoch, sequence: state.sequence });
  }

  private askKeyFrame(): void {
    const now = this.now();
    if (now - this.lastKeyRequest < KEY_FRAME_MS) return;
    this.lastKeyRequest = now;
    this.keyFramesAsked++;
    // If the request fails, the next gap asks again.
    this.connection.request('stream.key_frame', { session: this.session }).catch(() => undefined);
  }
}
