// SPDX-License-Identifier: GPL-3.0-or-later
// The page keeps up with a 60 Hz stream of the layers scene being cut, drawn in software. The daemon may
// be slower than that on a busy machine, so its frames are recorded first and then played at 60 Hz sharp;
// a page that fell behind would show it as latency that grows with the stream.
import type { Browser, CDPSession } from 'playwright-core';

import { Daemon } from './daemon';
import { record, Replay, type Recording } from './replay';
import { launch, ViewerPage } from './viewer_page';

const SESSION = 'd1-layers';
const RATE_HZ = 60;
const FRAMES = 300;
const WORK_MS_MAX = 4; // of the page's main thread for a frame of the stream
/** A page that takes a tenth longer than a frame lasts is 500 ms behind after these frames. */
const BEHIND_MS_MAX = 400;
const HOT_C = 700;

const median = (values: readonly number[]): number => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** The hook goes down at once and is drawn through the fascia, hot. */
function cutting(): (tick: number, call: (method: string, params: object) => void) => void {
  const tool = { session: SESSION, tool: 'hook' };
  let sequence = 0;
  let first: number | null = null;
  return (tick, call) => {
    if (first === null) {
      first = tick;
      call('tool.take_over', tool);
      call('tool.configure', { ...tool, shape: 'hook', hot_radius_m: 0.003, temperature_c: HOT_C });
      call('tool.energize', { ...tool, sequence: ++sequence, energized: true });
    }
    const x = -0.02 + 0.00012 * (tick - first);
    call('tool.move', { ...tool, sequence: ++sequence, position_m: [x, 0, 0.002], rotation: [0.9763, 0.21644, 0, 0], jaw: 0 });
  };
}

/** Processor time of the page's main thread in all its tasks: scripts, layout, collection of garbage. */
class ThreadMeter {
  private constructor(
    private readonly session: CDPSession,
    private readonly startedMs: number,
  ) {}

  static async on(viewer: ViewerPage): Promise<ThreadMeter> {
    const session = await viewer.page.context().newCDPSession(viewer.page);
    await session.send('Performance.enable', { timeDomain: 'threadTicks' });
    return new ThreadMeter(session, await taskMs(session));
  }

  async busyMs(): Promise<number> {
    return (await taskMs(this.session)) - this.startedMs;
  }
}

async function taskMs(session: CDPSession): Promise<number> {
  const { metrics } = await session.send('Performance.getMetrics');
  return 1000 * (metrics.find(({ name }) => name === 'TaskDuration')?.value ?? NaN);
}

describe('a stream of 60 frames a second', () => {
  const daemon = new Daemon(['--demo', 'layers']);
  let browser: Browser;
  let recording: Recording;

  beforeAll(async () => {
    await daemon.start();
    recording = await record(daemon.url, SESSION, FRAMES, cutting());
    await pauseSession();
    browser = await launch();
  });
  afterAll(async () => {
    await browser.close();
    await daemon.end();
  });

  async function pauseSession(): Promise<void> {
    let paused = false;
    await record(daemon.url, SESSION, 0, (_tick, call) => {
      if (!paused) call('session.pause', { session: SESSION });
      paused = true;
    });
  }

  it('is decoded whole and drawn without falling behind, with little work for the page', async () => {
    const replay = new Replay(daemon.url, recording, RATE_HZ);
    const viewer = await ViewerPage.open(browser, await replay.start());
    await viewer.until(() => window.cautery.tick > 0, null, 'the stream has begun');
    const meter = await ThreadMeter.on(viewer);
    const first = await viewer.state();
    await viewer.until((last) => window.cautery.tick === last, replay.lastTick, 'the last frame is on the page');
    const busyMs = await meter.busyMs();
    await viewer.drawn();
    const last = await viewer.state();
    const latencies = await viewer.page.evaluate(() => window.cautery.latenciesMs());
    const [early, late] = [median(latencies.slice(0, RATE_HZ)), median(latencies.slice(-RATE_HZ))];
    const busyPerFrameMs = busyMs / (last.framesDecoded - first.framesDecoded);
    process.stdout.write(
      `stream: ${replay.sent} deltas sent at ${RATE_HZ} Hz, ${last.framesDecoded} frames decoded, ${last.picturesDrawn} pictures; ` +
        `latency ${early.toFixed(1)} ms in the first second, ${late.toFixed(1)} ms in the last; ` +
        `the page's thread ${busyPerFrameMs.toFixed(2)} ms a frame, drawing commands included\n`,
    );
    expect(replay.sent).toBe(FRAMES);
    expect(last.framesDecoded).toBe(FRAMES + 1); // and the key frame
    expect(last.framesSkipped).toBe(0);
    expect(replay.asked).not.toContain('stream.key_frame');
    expect(last.drawnFaces['fascia']).toBeLessThan(first.drawnFaces['fascia']);
    expect(late).toBeLessThan(BEHIND_MS_MAX);
    expect(last.picturesDrawn).toBeGreaterThan(first.picturesDrawn);
    expect(busyPerFrameMs).toBeLessThan(WORK_MS_MAX);
    await viewer.close();
    await replay.end();
  });
});
