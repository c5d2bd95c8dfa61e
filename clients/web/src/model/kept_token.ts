// SPDX-License-Identifier: GPL-3.0-or-later
// The access token of this tab. An invitation carries it in the fragment of a link, which no browser sends to a server.
// The page removes it from the address at once, and keeps it in the storage of this tab, so that it asks once.
import type { Model } from './model';

const FRAGMENT = /^#token=(.+)$/;
const KEY = 'token';

/** The token of a link, or of this tab before it was reloaded. */
export function takeToken(): string | undefined {
  const given = FRAGMENT.exec(window.location.hash)?.[1];
  if (given === undefined) return sessionStorage.getItem(KEY) ?? undefined;
  window.history.replaceState(null, '', window.location.pathname + window.location.search);
  return decodeURIComponent(given);
}

/** The fragment of a link that carries a token. */
export function tokenFragment(token: string): string {
  return `token=${encodeURIComponent(token)}`;
}

/** Keeps a token that was accepted, and forgets one that was refused. */
export function keepToken(model: Model, token: () => string | undefined): void {
  model.on('link', (link) => {
    const now = token();
    if (link.state === 'online' && now !== undefined) sessionStorage.setItem(KEY, now);
    if (link.state === 'refused' && link.status === 'unauthorized') sessionStorage.removeItem(KEY);
  });
}
