// SPDX-License-Identifier: GPL-3.0-or-later
// The worker: owns the socket, decodes every frame, hands the newest state to the page.
import { momentOf } from '../model/history';
import type { ShownScalar } from '../model/tissue';
import { isChunk, readChunk } from './chunk';
import { Connection, RpcError } from './connection';
import { decoderReady } from './elements';
import { Feed } from './feed';
import { Downloads, upload } from './files';
import { Subscription } from './subscription';
import type { Channels, FromWorker, Sample, ToWorker } from './worker_messages';
import { FrameDecoder, type StreamState } from './decoder';
import type { PastFrame, Pushes, SessionDescription, Transfer } from './messages.gen';

/** The few names of a worker's global scope that are used; the DOM's types have no room for both. */
interface WorkerScope {
  postMessage(message: FromWorker, transfer?: Transferable[]): void;
  onmessage: ((event: MessageEvent<ToWorker>) => void) | null;
}
const scope = self as unknown as WorkerScope;

const CLOCK_US = 2e6;

let connection: Connection | null = null;
let subscription: Subscription | null = null;
let feed: Feed | null = null;
let clockOffsetUs = 0; // clock of the daemon minus the clock of this worker
let leastDelayUs = Infinity;
let nextMeasureUs = 0;
let shown: ShownScalar = 'blood';
const downloads = new Downloads((file) => scope.postMessage({ type: 'file', ...file }, [file.bytes.buffer]));

const nowUs = (): number => Math.round(performance.now() * 1000);

function fail(call: number, error: unknown): void {
  const message = error instanceof Error ? error.message : String(error);
  const known = error instanceof RpcError ? error : null;
  const path = known?.path === undefined ? {} : { path: known.path };
  scope.postMessage({ type: 'failure', call, status: known?.status ?? 'internal', message, ...path });
}

/**
 * Passes the page's sign of life on, and never gives one of its own: a page that hangs must lose its
 * energy. Now and then it is a request, whose answer shows the offset of the clocks; the least delay of
 * several shows it best.
 */
async function heartbeat(visible: boolean, atUs: number): Promise<void> {
  const sent = nowUs();
  if (!connection?.online) return;
  if (sent < nextMeasureUs) {
    connection.notify('heartbeat', { visible, client_time_us: atUs });
    return;
  }
  nextMeasureUs = sent + CLOCK_US;
  const { server_time_us: server } = await connection.request('heartbeat', { visible, client_time_us: atUs });
  const delay = nowUs() - sent;
  if (delay > leastDelayUs) return;
  leastDelayUs = delay;
  clockOffsetUs = server - (sent + delay / 2);
}

let later: ReturnType<typeof setTimeout> | null = null;

/** Behind frames that wait to be decoded: a worker that is late decodes first, and hands the newest of them over. */
function handOver(): void {
  later ??= setTimeout(() => {
    later = null;
    handOverNow();
  }, Math.max(feed?.restMs ?? 0, 0));
}

function handOverNow(): void {
  const frame = feed?.handOver(subscription?.framesDecoded ?? 0, subscription?.framesSkipped ?? 0);
  if (!frame) return;
  const { position, normal, burn } = frame.buffers;
  const lips = frame.lips.flatMap(({ band, wall, fringe }) => [band, wall, fringe].map(({ records }) => records.buffer));
  scope.postMessage({ type: 'frame', frame }, [position.buffer, normal.buffer, burn.buffer, ...lips]);
}

function sampleOf(state: StreamState, bytes: number, decodeMs: number): Sample {
  return {
    atS: performance.now() / 1000,
    tick: state.tick,
    latencyMs: Math.max(0, nowUs() + clockOffsetUs - state.publishedUs) / 1000,
    bytes,
    decodeMs,
    statistics: state.statistics,
    forceN: Math.max(0, ...state.tools.map((tool) => Math.hypot(...tool.forceN))),
    energyJ: state.tools.reduce((sum, tool) => sum + tool.energyJ, 0),
    moment: momentOf(state.tick, state.tools),
  };
}

const ARRIVES_MOST_MS = 30000;
let arrivesUntilMs = -Infinity;

function tellMoved(session: string, to: string, url = ''): void {
  scope.postMessage({ type: 'moved', session, to, url });
}

function follow(url: string): void {
  arrivesUntilMs = performance.now() + ARRIVES_MOST_MS;
  connection?.follow(url);
}

function pushed<M extends keyof Pushes>(method: M, params: Pushes[M]): void {
  scope.postMessage({ type: 'push', method, params });
  if (method !== 'session.changed') return;
  const { change, summary, target, moved_to: to } = params as Pushes['session.changed'];
  if (change === 'moved' && to !== undefined) tellMoved(summary.session, to, target);
}

/** Servers older than vessels refuse these two channels. So they are asked for only where the scene has vessels. */
const OF_VESSELS: Channels = ['vessels', 'blood'];
const hasVessels = ({ definition }: SessionDescription): boolean => (definition.vessels ?? []).length > 0;

function watch({ session, channels, scalar }: ToWorker & { type: 'watch' }): void {
  shown = scalar;
  if (subscription && subscription.session === session) {
    void subscription.start({ channels });
    return;
  }
  subscription?.stop();
  subscription = null;
  feed = null;
  if (session === null || !connection) return;
  let received = performance.now();
  subscription = new Subscription(connection, session, { channels }, {
    ask: (description, join) => (hasVessels(description) ? { ...join, channels: [...(join.channels ?? []), ...OF_VESSELS] } : join),
    joined: (description, stream, topology) => {
      feed = new Feed(description, stream, topology, shown);
      connection?.found();
      scope.postMessage({ type: 'joined', joined: feed.joined });
    },
    frame: (state, changes, bytes) => {
      feed?.take(state, changes, sampleOf(state, bytes, performance.now() - received));
      handOver();
    },
    failed: (error) => {
      const status = error instanceof RpcError ? error.status : 'internal';
      if (error instanceof RpcError && error.movedTo !== undefined) {
        tellMoved(session, error.movedTo, error.url);
        return;
      }
      if (status === 'not_here' && performance.now() < arrivesUntilMs) { // the session is still moving here
        connection?.comeBack();
        return;
      }
      scope.postMessage({ type: 'not_joined', session, status, message: error instanceof Error ? error.message : String(error) });
    },
  });
  takeBytes = (bytes) => {
    received = performance.now();
    subscription?.take(bytes);
  };
  if (connection.online) void subscription.start();
}

let takeBytes: (bytes: Uint8Array) => void = () => undefined;

function connect(message: ToWorker & { type: 'connect' }): void {
  connection?.stop();
  subscription = null; // belongs to the old connection; the page subscribes again
  feed = null;
  const { url, client, clientId, token } = message;
  const options = { url, client, clientId, ...(token === undefined ? {} : { token }) };
  connection = new Connection(options, (address, protocol) => new WebSocket(address, protocol), {
    state: (state) => {
      scope.postMessage({ type: 'link', state });
      if (state.state !== 'online') return;
      clockOffsetUs = state.hello.server_time_us - nowUs();
      nextMeasureUs = 0;
      if (subscription) void subscription.start();
    },
    push: pushed,
    binary: (bytes) => (isChunk(bytes) ? downloads.take(readChunk(bytes)) : takeBytes(bytes)),
  });
  connection.start();
  leastDelayUs = Infinity;
}

function call(message: ToWorker & { type: 'call' }): void {
  const { call: number, method, params } = message;
  if (!connection) return;
  connection.request(method, params as never).then(
    (result) => {
      if (method === 'session.export' || method === 'session.log') downloads.announce(result as Transfer);
      scope.postMessage({ type: 'answer', call: number, result });
    },
    (error: unknown) => fail(number, error),
  );
}

function send(message: ToWorker & { type: 'upload' }): void {
  const { call: number, name, fileName } = message;
  const bytes = new Uint8Array(message.bytes);
  const total = bytes.byteLength;
  if (!connection) return;
  upload(connection, name, fileName, bytes, (sent) => scope.postMessage({ type: 'progress', call: number, sent, total })).then(
    (result) => scope.postMessage({ type: 'answer', call: number, result }),
    (error: unknown) => fail(number, error),
  );
}

/** A whole frame of the past; its hash says that nothing of it was lost. */
function download(found: PastFrame): Promise<StreamState> {
  return new Promise((resolve, reject) => {
    downloads.announce(found, ({ bytes, sound }) => {
      const decoder = new FrameDecoder(found);
      if (sound && decoder.decode(bytes).kind === 'applied') resolve(decoder.state);
      else reject(new RpcError('corrupt', 'a frame was damaged in transfer'));
    });
  });
}

/** Only the newest wish is shown: what was asked for before it may still be on its way. */
let wished = 0;

function showPresent(): void {
  wished++;
  feed?.look(null);
  handOver();
}

async function showPast({ call: number, session, tick }: ToWorker & { type: 'past' }): Promise<void> {
  const wish = ++wished;
  const of = feed;
  if (!connection || !of) {
    fail(number, new RpcError('bad_state', 'no session is open; choose or create one'));
    return;
  }
  const { channels, step_m } = of.joined.stream;
  try {
    const state = await download(await connection.request('session.frame_at', { session, tick, channels, step_m }));
    if (wish === wished && of === feed) {
      of.look(state);
      handOver();
    }
    scope.postMessage({ type: 'answer', call: number, result: null });
  } catch (error) {
    fail(number, error);
  }
}

async function receive(message: ToWorker): Promise<void> {
  await decoderReady;
  switch (message.type) {
    case 'follow':
      follow(message.url);
      break;
    case 'connect':
      connect(message);
      break;
    case 'call':
      call(message);
      break;
    case 'notice':
      connection?.notify(message.method, message.params as never);
      break;
    case 'heartbeat':
      await heartbeat(message.visible, message.atUs).catch(() => undefined); // a loss is reported by the state of the link
      break;
    case 'watch':
      watch(message);
      break;
    case 'inspect':
      scope.postMessage({ type: 'answer', call: message.call, result: feed?.vertex(message.vertex) ?? null });
      break;
    case 'past':
      await showPast(message);
      break;
    case 'present':
      showPresent();
      break;
    case 'upload':
      send(message);
      break;
    case 'return':
      feed?.giveBack(message.buffers);
      handOver();
      break;
  }
}

scope.onmessage = (event) => void receive(event.data);
