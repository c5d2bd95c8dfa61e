// SPDX-License-Identifier: GPL-3.0-or-later
// The access token of this tab. An invitation carries it in the fragment of a link, which no browser sends to a server.
// The page removes it from the address at once. It stores the token for this tab, so that the user enters it only once.
import type { Model } from './model';

const FRAGMENT = /^#token=(.+)$/;
const KEY = 'token';

/** Returns the token from the link, or the token that this tab stored before a reload. */
export function takeToken(): string | undefined {
  const given = FRAGMENT.exec(window.location.hash)?.[1];
  if (given === undefined) return sessionStorage.getItem(KEY) ?? undefined;
  window.history.replaceState(null, '', window.location.pathname + window.location.search);
  return decodeURIComponent(given);
}

/** Returns the fragment of a link with a token. */
export function tokenFragment(token: string): string {
  return `token=${encodeURIComponent(token)}`;
}

/** Stores a token that was accepted, and removes a token that was refused. */
export function keepToken(model: Model, token: () => string | undefined): void {
  model.on('link', (link) => {
    const now = token();
    if (link.state === 'online' && now !== undefined) sessionStorage.setItem(KEY, now);
    if (link.state === 'refused' && link.status === 'unauthorized') sessionStorage.removeItem(KEY);
  });
}
