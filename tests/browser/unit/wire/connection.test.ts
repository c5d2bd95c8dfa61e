// SPDX-License-Identifier: GPL-3.0-or-later
import { Connection, RpcError, type LinkState, type Socket } from '../../../../clients/web/src/wire/connection';
import type { HelloResult } from '../../../../clients/web/src/wire/messages.gen';

/** A socket whose other end is the test. */
class FakeSocket implements Socket {
  binaryType: BinaryType = 'blob';
  onopen: Socket['onopen'] = null;
  onclose: Socket['onclose'] = null;
  onmessage: Socket['onmessage'] = null;
  readonly sent: { id?: number; method: string; params: Record<string, unknown> }[] = [];

  send(data: string | ArrayBufferView): void {
    if (typeof data === 'string') this.sent.push(JSON.parse(data) as (typeof this.sent)[number]);
  }
  close(): void {
    this.lose(1000);
  }
  open(): void {
    this.onopen?.({} as Event);
  }
  say(message: object): void {
    this.onmessage?.({ data: JSON.stringify({ jsonrpc: '2.0', ...message }) } as MessageEvent);
  }
  lose(code: number): void {
    this.onclose?.({ code, reason: '' } as CloseEvent);
  }
  last(method: string): FakeSocket['sent'][number] {
    const found = this.sent.filter((message) => message.method === method).at(-1);
    if (!found) throw new Error(`no ${method} was sent`);
    return found;
  }
}

const HELLO = { client: 4, resume: 'again', role: 'admin' } as unknown as HelloResult;

function setUp(): { sockets: FakeSocket[]; states: LinkState[]; pushes: string[]; connection: Connection } {
  const sockets: FakeSocket[] = [];
  const states: LinkState[] = [];
  const pushes: string[] = [];
  const connection = new Connection(
    { url: 'ws://host/v1', client: 'viewer test', clientId: 'me' },
    () => {
      sockets.push(new FakeSocket());
      return sockets.at(-1)!;
    },
    { state: (state) => states.push(state), push: (method) => pushes.push(method), binary: () => undefined },
  );
  connection.start();
  return { sockets, states, pushes, connection };
}

async function greet(socket: FakeSocket): Promise<void> {
  socket.open();
  socket.say({ id: socket.last('hello').id, result: HELLO });
  await Promise.resolve();
  await Promise.resolve();
}

describe('a connection', () => {
  beforeEach(() => void vi.useFakeTimers());
  afterEach(() => void vi.useRealTimers());

  it('says hello first and serves nothing before the answer', async () => {
    const { sockets, states, connection } = setUp();
    const asked = connection.request('session.list', {});
    sockets[0].open();
    expect(sockets[0].sent.map(({ method }) => method)).toEqual(['hello']);
    expect(sockets[0].last('hello').params).toEqual({ version: 1, client: 'viewer test', client_id: 'me' });
    await greet(sockets[0]);
    expect(states.map(({ state }) => state)).toEqual(['connecting', 'online']);
    sockets[0].say({ id: sockets[0].last('session.list').id, result: { sessions: [] } });
    expect(await asked).toEqual({ sessions: [] });
  });

  it('comes back with the resume token and sends unanswered changes again under the same number', async () => {
    const { sockets, states, connection } = setUp();
    await greet(sockets[0]);
    void connection.request('session.pause', { session: 'd1-a' });
    const first = sockets[0].last('session.pause');
    expect(first.params['client_sequence']).toBe(1);
    sockets[0].lose(1006);
    expect(states.at(-1)).toMatchObject({ state: 'lost' });
    vi.advanceTimersByTime(1000);
    await greet(sockets[1]);
    expect(sockets[1].last('hello').params['resume']).toBe('again');
    expect(sockets[1].last('session.pause')).toEqual(first);
    expect(states.at(-1)).toMatchObject({ state: 'online', again: true });
  });

  it('never sends a command to a tool again: it was meant for its moment', async () => {
    const { sockets, connection } = setUp();
    await greet(sockets[0]);
    const energize = connection.request('tool.energize', { tool: 'hook', energized: true });
    sockets[0].lose(1006);
    await expect(energize).rejects.toThrow('lost');
    await expect(connection.request('tool.energize', { tool: 'hook', energized: true })).rejects.toThrow(RpcError);
    vi.advanceTimersByTime(1000);
    await greet(sockets[1]);
    expect(sockets[1].sent.some(({ method }) => method === 'tool.energize')).toBe(false);
  });

  it('waits longer after each failure, up to a bound', async () => {
    const { sockets, states } = setUp();
    const waits: number[] = [];
    for (let i = 0; i < 9; i++) {
      sockets[i].lose(1006);
      const state = states.at(-1)!;
      waits.push(state.state === 'lost' ? state.retryInS : 0);
      vi.advanceTimersByTime(10_001);
    }
    expect(waits[0]).toBeLessThan(0.4);
    expect(waits[8]).toBeGreaterThan(waits[2]);
    expect(Math.max(...waits)).toBeLessThanOrEqual(10);
    await greet(sockets[9]);
    sockets[9].lose(1006);
    const state = states.at(-1)!;
    expect(state.state === 'lost' && state.retryInS).toBeLessThan(0.4);
  });

  it('explains a version that is not spoken, and does not try again', async () => {
    const { sockets, states } = setUp();
    sockets[0].open();
    sockets[0].say({ id: 1, error: { code: -32044, message: 'no', data: { status: 'version' } } });
    await Promise.resolve();
    await Promise.resolve();
    expect(states.at(-1)).toMatchObject({ state: 'refused', status: 'version' });
    const state = states.at(-1)!;
    expect(state.state === 'refused' && state.words).toContain('different versions');
    vi.advanceTimersByTime(60_000);
    expect(sockets).toHaveLength(1);
  });

  it('asks for a token when the daemon wants one', () => {
    const { sockets, states } = setUp();
    sockets[0].open();
    sockets[0].lose(4002);
    expect(states.at(-1)).toMatchObject({ state: 'refused', status: 'unauthorized' });
  });

  it('gives errors with the offending member and the daemon’s reason', async () => {
    const { sockets, connection } = setUp();
    await greet(sockets[0]);
    const asked = connection.request('session.speed', { speed: 99 });
    const data = { status: 'bad_value', path: 'params.speed', reason: '99 is outside 0.01 to 10' };
    sockets[0].say({ id: sockets[0].last('session.speed').id, error: { code: -32602, message: 'bad', data } });
    await expect(asked).rejects.toMatchObject({ status: 'bad_value', path: 'params.speed', message: data.reason });
  });

  it('passes notifications on', async () => {
    const { sockets, pushes } = setUp();
    await greet(sockets[0]);
    sockets[0].say({ method: 'session.faulted', params: { session: 'd1-a', tick: 3, reason: 'x' } });
    expect(pushes).toEqual(['session.faulted']);
  });

  it('goes after a session with the same identity, until it is found', async () => {
    const { sockets, connection } = setUp();
    await greet(sockets[0]);
    const asked = connection.request('session.describe', { session: 'd1-knee' });
    const data = { status: 'moved', reason: 'it is `d2-knee` now', moved_to: 'd2-knee', url: 'ws://other' };
    sockets[0].say({ id: sockets[0].last('session.describe').id, error: { message: 'moved', data } });
    await expect(asked).rejects.toMatchObject({ status: 'moved', movedTo: 'd2-knee', url: 'ws://other' });
    connection.follow('ws://host/v1?session=d2-knee');
    await vi.advanceTimersByTimeAsync(0);
    expect(sockets).toHaveLength(2); // the second socket is opened at once
    sockets[1].open();
    sockets[1].say({ id: sockets[1].last('hello').id, result: { ...HELLO, resume: 'too-early' } });
    await vi.advanceTimersByTimeAsync(0);
    connection.comeBack(); // the page has not arrived there yet
    await vi.advanceTimersByTimeAsync(1000);
    sockets[2].open();
    expect(sockets[2].last('hello').params).toMatchObject({ client_id: 'me', resume: 'again' });
    sockets[2].say({ id: sockets[2].last('hello').id, result: { ...HELLO, resume: 'there' } });
    await vi.advanceTimersByTimeAsync(0);
    connection.found();
    sockets[2].lose(1006);
    await vi.advanceTimersByTimeAsync(1000);
    sockets[3].open();
    expect(sockets[3].last('hello').params).toMatchObject({ resume: 'there' });
  });
});
