// SPDX-License-Identifier: GPL-3.0-or-later
// A stream at exactly its rate, whatever the machine's load. A proxy in front of the daemon plays the recorded frames of a
// real session to the page, from the moment that the test chooses. It passes all other messages on.
import { Door, type Said } from './door';
import { tickOf, type Recording } from './recording';
import { MessageSocket } from './socket';

const PUBLISHED_AT = 56; // offset of published_us in a frame's header
const LOOK_MS = 2;
const WHOLE = 2; // the first frames: topology and key

export class Replay extends Door {
  /** deltas sent so far, and the tick of the last */
  sent = 0;
  readonly lastTick: number;
  private page: MessageSocket | undefined;
  private timer: NodeJS.Timeout | undefined;
  private clockUs = 0; // the daemon's clock when this one stood at 0

  constructor(
    daemonUrl: string,
    private readonly recording: Recording,
    private readonly rateHz: number,
  ) {
    super(daemonUrl);
    this.lastTick = tickOf(recording.frames[recording.frames.length - 1]);
  }

  override async end(): Promise<void> {
    clearInterval(this.timer);
    await super.end();
  }

  protected override text({ page, text, method }: Said): void {
    super.text({ page, text, method });
    const { result } = JSON.parse(text) as { result?: { server_time_us?: number } };
    if (method === 'hello') this.clockUs = (result?.server_time_us ?? 0) - 1000 * performance.now();
    if (method !== 'session.join') return;
    this.page = page;
    for (const frame of this.recording.frames.slice(0, WHOLE)) this.send(frame);
  }

  /** The daemon's own frames stay out: the session is paused, and the page sees the recording. */
  protected override binary(): void {}

  /** The deltas, to the page that has joined. */
  play(): void {
    const deltas = this.recording.frames.slice(WHOLE);
    const started = performance.now();
    this.timer = setInterval(() => {
      const due = Math.min(Math.floor(((performance.now() - started) * this.rateHz) / 1000), deltas.length);
      while (this.sent < due) this.send(deltas[this.sent++]);
      if (this.sent === deltas.length) clearInterval(this.timer);
    }, LOOK_MS);
  }

  private send(frame: Buffer): void {
    frame.writeBigUInt64LE(BigInt(Math.round(this.clockUs + 1000 * performance.now())), PUBLISHED_AT);
    this.page!.sendBinary(frame);
  }
}
