// SPDX-License-Identifier: GPL-3.0-or-later
// Who sits at this page, for the others in the session: a name of one's own, or one made up for this tab,
// so that two people always have two names.

const CHOSEN = 'name'; // kept by the browser
const MADE_UP = 'guest'; // kept by the tab, over reloads
const TREES = [
  'Alder', 'Ash', 'Aspen', 'Beech', 'Birch', 'Cedar', 'Cherry', 'Elm', 'Fir', 'Hazel', 'Holly', 'Larch', 'Laurel', 'Lime',
  'Maple', 'Oak', 'Olive', 'Pine', 'Plane', 'Poplar', 'Rowan', 'Spruce', 'Walnut', 'Willow',
];
const NUMBERS = 90; // two digits, after the first ten
export const NAME_MAX = 40;
const PROGRAM = /, viewer \S+$/;

function makeUp(): string {
  const [tree, number] = crypto.getRandomValues(new Uint32Array(2));
  return `${TREES[tree % TREES.length]} ${10 + (number % NUMBERS)}`;
}

export function ownName(): string {
  const chosen = localStorage.getItem(CHOSEN);
  if (chosen !== null) return chosen;
  const made = sessionStorage.getItem(MADE_UP) ?? makeUp();
  sessionStorage.setItem(MADE_UP, made);
  return made;
}

/** Takes a name of one's own; an empty one goes back to the made-up. */
export function setOwnName(name: string): void {
  const trimmed = name.trim().slice(0, NAME_MAX);
  if (trimmed === '') localStorage.removeItem(CHOSEN);
  else localStorage.setItem(CHOSEN, trimmed);
}

/** What the daemon and its other clients are told. */
export function clientWords(version: string): string {
  return `${ownName()}, viewer ${version}`;
}

/** Somebody's name as people say it; programs without one go by their number. */
export function nameOf({ name, client }: { name: string; client: number }): string {
  const bare = name.replace(PROGRAM, '');
  return bare === '' ? `client ${client}` : bare;
}
