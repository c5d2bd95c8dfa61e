// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the list of the sessions of the other daemons of a fleet.
import type { Model } from '../model/model';
import { fleetLabels, sessionsOf } from '../wire/fleet';
import { newClientId } from '../wire/link';

const REFRESH_MS = 10000; // needs a connection to each daemon, so it is slower than for this daemon's sessions

function labelOf(session: string): string {
  return session.split('-', 1)[0];
}

/** `token`: what the page's own connection is made with. */
export function keepFleet(model: Model, client: string, token: () => string | undefined): void {
  let labels: string[] = [];
  const refresh = async (): Promise<void> => {
    const own = model.sessions.map(({ session }) => labelOf(session));
    const others = labels.filter((label) => !own.includes(label));
    const lists = await Promise.all(others.map((label) => {
      const url = new URL(`./v1?label=${label}`, window.location.href);
      url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
      const secret = token();
      return sessionsOf({ url: url.href, client, clientId: newClientId(), ...(secret === undefined ? {} : { token: secret }) },
        (address, protocol) => new WebSocket(address, protocol));
    }));
    const here = new Set(model.sessions.map(({ session }) => session));
    model.setElsewhere(lists.flatMap((list) => list ?? []).filter(({ session }) => !here.has(session)),
      others.filter((_, index) => lists[index] === null));
  };
  model.on('link', ({ state }) => {
    if (state !== 'online') return;
    void fleetLabels(new URL('./api/fleet', window.location.href).href).then((told) => {
      labels = told;
      if (labels.length > 0) void refresh();
    });
  });
  setInterval(() => {
    if (labels.length > 0 && !document.hidden && model.link.state === 'online') void refresh();
  }, REFRESH_MS);
}
