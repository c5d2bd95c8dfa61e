// SPDX-License-Identifier: GPL-3.0-or-later
import type { Connection } from '../../../../clients/web/src/wire/connection';
import { decoderReady } from '../../../../clients/web/src/wire/elements';
import { Subscription, type SubscriptionEvents } from '../../../../clients/web/src/wire/subscription';
import { example } from './examples';

const STREAM = { session: 'd1-a', session_number: 7, profile: 1, vertex_count: 3, face_count: 1 };
const TOPOLOGY = example('A topology frame');
const KEY = example('A key frame');
const DELTA = example('The delta after it');

interface Said {
  method: string;
  params: Record<string, unknown>;
}

async function joined(ask?: SubscriptionEvents['ask']): Promise<{ subscription: Subscription; said: Said[]; sequences: number[]; clock: { now: number } }> {
  const said: Said[] = [];
  const sequences: number[] = [];
  const clock = { now: 1000 };
  const connection = {
    online: true,
    request: (method: string, params: Said['params']) => {
      said.push({ method, params });
      return Promise.resolve(method === 'session.join' ? STREAM : {});
    },
    notify: (method: string, params: Said['params']) => said.push({ method, params }),
  } as unknown as Connection;
  const subscription = new Subscription(connection, 'd1-a', { channels: ['positions'] }, {
    ...(ask ? { ask } : {}),
    joined: () => undefined,
    frame: (state) => sequences.push(state.sequence),
    failed: (error) => {
      throw error;
    },
  }, () => clock.now);
  await subscription.start();
  return { subscription, said, sequences, clock };
}

const asks = (said: readonly Said[], method: string): number => said.filter((message) => message.method === method).length;

beforeAll(async () => decoderReady);

describe('a subscription', () => {
  it('describes, joins, decodes and acknowledges', async () => {
    const { subscription, said, sequences } = await joined();
    for (const frame of [TOPOLOGY, KEY, DELTA]) subscription.take(frame);
    expect(sequences).toEqual([1, 2]);
    expect(said.map(({ method }) => method)).toEqual(['session.describe', 'session.join', 'stream.ack']);
    expect(said[2].params).toEqual({ session: 'd1-a', epoch: '0123456789abcdef', sequence: 1 });
  });

  it('joins with what the session calls for', async () => {
    const { said } = await joined((description, given) => ({ ...given, channels: description === undefined ? [] : [...(given.channels ?? []), 'vessels'] }));
    expect(said[1].params).toEqual({ session: 'd1-a', channels: ['positions', 'vessels'] });
    expect((await joined()).said[1].params).toEqual({ session: 'd1-a', channels: ['positions'] });
  });

  it('asks for a key frame after a gap, at most once a second', async () => {
    const { subscription, said, sequences, clock } = await joined();
    for (const frame of [TOPOLOGY, DELTA, DELTA]) subscription.take(frame);
    expect(asks(said, 'stream.key_frame')).toBe(1);
    clock.now += 1001;
    subscription.take(DELTA);
    expect(asks(said, 'stream.key_frame')).toBe(2);
    subscription.take(KEY);
    subscription.take(DELTA);
    expect(sequences).toEqual([1, 2]);
    expect(subscription.framesSkipped).toBe(3);
  });

  it('asks for a key frame after a damaged one', async () => {
    const { subscription, said } = await joined();
    subscription.take(TOPOLOGY);
    subscription.take(KEY);
    const damaged = DELTA.slice();
    damaged[0x5c] = 9;
    subscription.take(damaged);
    expect(asks(said, 'stream.key_frame')).toBe(1);
  });

  it('is deaf after it ended', async () => {
    const { subscription, sequences, said } = await joined();
    subscription.take(TOPOLOGY);
    subscription.stop();
    subscription.take(KEY);
    expect(sequences).toEqual([]);
    expect(asks(said, 'session.leave')).toBe(1);
  });
});
