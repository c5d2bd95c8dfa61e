// SPDX-License-Identifier: GPL-3.0-or-later
import type { Socket } from '../../../../clients/web/src/wire/connection';
import { readLabels, sessionsOf } from '../../../../clients/web/src/wire/fleet';

/** A socket to a daemon that always gives the same answer to a method. */
class Daemon implements Socket {
  binaryType: BinaryType = 'blob';
  onopen: Socket['onopen'] = null;
  onclose: Socket['onclose'] = null;
  onmessage: Socket['onmessage'] = null;
  closed = 0;
  token: string | undefined;

  constructor(private readonly answers: Record<string, object>) {
    queueMicrotask(() => this.onopen?.({} as Event));
  }
  send(data: string | ArrayBufferView): void {
    const { id, method, params } = JSON.parse(data as string) as { id: number; method: string; params: { token?: string } };
    if (method === 'hello') this.token = params.token;
    if (method in this.answers) queueMicrotask(() => this.onmessage?.({ data: JSON.stringify({ jsonrpc: '2.0', id, ...this.answers[method] }) } as MessageEvent));
  }
  close(): void {
    this.closed++;
  }
}

const options = { url: 'ws://host/v1?label=d2', client: 'viewer test', clientId: 'me', token: 'secret' };
const HELLO = { result: { client: 4, resume: 'again', role: 'view' } };

describe('a fleet', () => {
  afterEach(() => void vi.useRealTimers());

  it('has the labels that the proxy tells', () => {
    expect(readLabels({ labels: ['d1', 'ward_3'], more: 1 })).toEqual(['d1', 'ward_3']);
    for (const none of [{ labels: [] }, {}, null, 'd1', { labels: 'd1' }, { labels: ['d1', 2] }, { labels: ['d-1'] }, { labels: ['D1'] }])
      expect(readLabels(none)).toEqual([]);
  });

  it('is asked for the sessions of each daemon, with the same token, and left again', async () => {
    const daemon = new Daemon({ hello: HELLO, 'session.list': { result: { sessions: [{ session: 'd2-knee' }] } } });
    expect(await sessionsOf(options, () => daemon)).toEqual([{ session: 'd2-knee' }]);
    expect(daemon.token).toBe('secret');
    expect(daemon.closed).toBe(1);
  });

  it('says of a daemon that it does not answer, and does not come back to it', async () => {
    vi.useFakeTimers();
    const refusing = new Daemon({ hello: { error: { code: -32001, message: 'no', data: { status: 'unauthorized' } } } });
    expect(await sessionsOf(options, () => refusing)).toBeNull();
    let opened = 0;
    const gone = sessionsOf(options, () => {
      opened++;
      const socket = new Daemon({});
      socket.onopen = null;
      queueMicrotask(() => socket.onclose?.({ code: 1006, reason: '' } as CloseEvent));
      return socket;
    });
    expect(await gone).toBeNull();
    await vi.advanceTimersByTimeAsync(60000);
    expect(opened).toBe(1);
  });

  it('waits for nobody for long', async () => {
    vi.useFakeTimers();
    const silent = new Daemon({});
    const asked = sessionsOf(options, () => silent);
    await vi.advanceTimersByTimeAsync(5000);
    expect(await asked).toBeNull();
    expect(silent.closed).toBe(1);
  });
});
