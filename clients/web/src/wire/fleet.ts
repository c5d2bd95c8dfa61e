// SPDX-License-Identifier: Apache-2.0
// The daemons behind this address, where a proxy stands in front of several. A connection serves one of them, so the
// sessions of each other are asked on a connection of its own, which is closed again.
import { Connection, type ConnectionOptions, type Socket } from './connection';
import type { SessionSummary } from './messages.gen';

const PATIENCE_MS = 5000;
const LABELS_MAX = 1024;
const LABEL = /^[a-z][a-z0-9]*(_[a-z0-9]+)*$/;

/** The labels that an answer of /api/fleet tells; none: one daemon alone, or no such answer. */
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
    return []; // the connection itself says what is wrong
  }
}

/** What a daemon has; null: it does not answer, or not to this token. */
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
        // after what the connection itself does then, which is to try again
        if (state === 'lost' || state === 'refused') queueMicrotask(() => finish(null));
      },
      push: () => undefined,
      binary: () => undefined,
    });
    connection.start();
  });
}
