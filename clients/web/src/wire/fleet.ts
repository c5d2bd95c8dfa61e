// SPDX-License-Identifier: Apache-2.0
// The daemons behind this address, if a proxy stands in front of several. A connection reaches only one daemon. So the
// sessions of each other daemon are requested on a separate connection, which is then closed.
import { Connection, type ConnectionOptions, type Socket } from './connection';
import type { SessionSummary } from './messages.gen';

const PATIENCE_MS = 5000;
const LABELS_MAX = 1024;
const LABEL = /^[a-z][a-z0-9]*(_[a-z0-9]+)*$/;

/** Returns the labels in an answer of /api/fleet; empty: a single daemon, or no such answer. */
export function readLabels(told: unknown): string[] {
  const labels: unknown = typeof told === 'object' && told !== null && 'labels' in told ? told.labels : null;
  if (!Array.isArray(labels) || labels.length > LABELS_MAX) return [];
  const names = labels.filter((label): label is string => typeof label === 'string' && LABEL.test(label));
  return names.length === labels.length ? names : [];
}

export async function fleetLabels(url: string): Promise<string[]> {
  try {
    const answer = await fetch(url, { cache: 'no-store' });
    return answer.ok ? readLabels(await answer.json()) : [];
  } catch {
    return []; // the connection reports the error
  }
}

/** Returns the sessions of a daemon; null: it does not answer, or refuses this token. */
export function sessionsOf(options: ConnectionOptions, open: (url: string, protocol: string) => Socket): Promise<SessionSummary[] | null> {
  return new Promise((resolve) => {
    const finish = (sessions: SessionSummary[] | null): void => {
      clearTimeout(timer);
      connection.stop();
      resolve(sessions);
    };
    const timer = setTimeout(() => finish(null), PATIENCE_MS);
    const connection = new Connection(options, open, {
      state: ({ state }) => {
        if (state === 'online') connection.request('session.list', {}).then(({ sessions }) => finish(sessions), () => finish(null));
        // after the handler of the connection, which would connect again
        if (state === 'lost' || state === 'refused') queueMicrotask(() => finish(null));
      },
      push: () => undefined,
      binary: () => undefined,
    });
    connection.start();
  });
}
