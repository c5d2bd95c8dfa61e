// SPDX-License-Identifier: GPL-3.0-or-later
// The name of the user for others in the session: a chosen name, or a name generated for this tab, so that two users always
// have different names.
import { text } from '../text/text';

const CHOSEN = 'name'; // key in the storage of the browser
const MADE_UP = 'guest'; // key in the storage of the tab, which survives reloads
const NUMBERS = 90; // two digits, after the first ten
export const NAME_MAX = 40;
const PROGRAM = /, viewer \S+$/;

function makeUp(): string {
  const { trees } = text.person;
  const [tree, number] = crypto.getRandomValues(new Uint32Array(2));
  return `${trees[tree % trees.length]} ${10 + (number % NUMBERS)}`;
}

export function ownName(): string {
  const chosen = localStorage.getItem(CHOSEN);
  if (chosen !== null) return chosen;
  const made = sessionStorage.getItem(MADE_UP) ?? makeUp();
  sessionStorage.setItem(MADE_UP, made);
  return made;
}

/** Sets the chosen name. An empty name restores the generated name. */
export function setOwnName(name: string): void {
  const trimmed = name.trim().slice(0, NAME_MAX);
  if (trimmed === '') localStorage.removeItem(CHOSEN);
  else localStorage.setItem(CHOSEN, trimmed);
}

/** Returns the client name in hello, which the daemon and other clients see. */
export function clientWords(version: string): string {
  return `${ownName()}, viewer ${version}`;
}

/** Returns the shown name of a client. A program without a name is shown by its number. */
export function nameOf({ name, client }: { name: string; client: number }): string {
  const bare = name.replace(PROGRAM, '');
  return bare === '' ? text.person.unnamed(client) : bare;
}
