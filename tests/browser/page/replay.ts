// SPDX-License-Identifier: GPL-3.0-or-later
// Plays a stream at exactly its rate, whatever the machine's load. A proxy in front of the daemon sends the recorded
// frames of a real session to the page, beginning when the test chooses. It passes all other messages on.
import { Door, type Said } from './door';
import { tickOf, type Recording } from './recording';
import { MessageSocket } from './socket';

const PUBLISHED_AT = 56; // offset of published_us in a frame's header
const LOOK_MS = 2;
const WHOLE = 2; // number of the frames before the deltas: topology and key frame

export class Replay extends Door {
  /** number of deltas sent so far; lastTick: tick of the last delta */
  sent = 0;
  readonly lastTick: number;
  private page: MessageSocket | undefined;
  private timer: NodeJS.Timeout | undefined;
  private clockUs = 0; // the daemon's clock at the time 0 of this process's clock

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

  /** Drops the daemon's own frames: the session is paused, and the page gets the recording. */
  protected override binary(): void {}

  /** Sends the deltas to the page that has joined. */
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
