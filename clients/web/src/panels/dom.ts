// SPDX-License-Identifier: GPL-3.0-or-later
// Short functions that create elements, and `attempt`, which shows the failure of work where it was started.

import { errorWords } from '../model/sentences';

type Child = Node | string | null;
type Props<T extends HTMLElement> = Partial<Omit<T, 'style' | 'dataset'>> & {
  class?: string;
  aria?: Readonly<Record<string, string>>;
  data?: Readonly<Record<string, string>>;
};

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  props: Props<HTMLElementTagNameMap[K]> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  const { class: className, aria, data, ...rest } = props;
  Object.assign(made, rest);
  if (className !== undefined) made.className = className;
  for (const [name, value] of Object.entries(aria ?? {})) made.setAttribute(name === 'role' ? name : `aria-${name}`, value);
  for (const [name, value] of Object.entries(data ?? {})) made.dataset[name] = value;
  made.append(...children.filter((child) => child !== null));
  return made;
}

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as T;
}

/** The place of a panel where errors are said. */
export function problemPlace(): HTMLParagraphElement {
  return element('p', { class: 'problem', hidden: true, aria: { role: 'alert' } });
}

function mark(busy: HTMLButtonElement | undefined, working: boolean): void {
  if (!busy) return;
  busy.disabled = working;
  busy.ariaBusy = String(working);
}

/** Runs work, `busy` being marked so meanwhile; on failure its words stand in `place` until the next attempt. */
export async function attempt<T>(place: HTMLElement, work: () => Promise<T>, busy?: HTMLButtonElement): Promise<T | null> {
  place.hidden = true;
  mark(busy, true);
  try {
    return await work();
  } catch (error) {
    place.textContent = errorWords(error);
    place.hidden = false;
    return null;
  } finally {
    mark(busy, false);
  }
}

/** A labelled control in a row. */
export function field(label: string, control: HTMLElement, unit = '', title = ''): HTMLLabelElement {
  return element('label', { class: 'field', title }, element('span', {}, label), control, element('small', {}, unit));
}

export function button(words: string, press: () => void, props: Props<HTMLButtonElement> = {}): HTMLButtonElement {
  return element('button', { type: 'button', onclick: press, ...props }, words);
}

/** A box to tick. */
export function check(words: string, name: string, change: (on: boolean) => void, checked = false): HTMLElement {
  const box = element('input', { type: 'checkbox', name, checked });
  box.addEventListener('change', () => change(box.checked));
  return element('label', { class: 'check' }, box, words);
}

export function save(name: string, data: Blob): void {
  const link = element('a', { href: URL.createObjectURL(data), download: name });
  link.click();
  // No browser reports when it has saved the file. Some browsers save an empty file if the URL is revoked at once.
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A number in few digits: 1.2e-5 and 0.00032 as 12 µ and 320 µ would hide the unit, so plain powers. */
export function short(value: number, digits = 3): string {
  if (value === 0) return '0';
  const size = Math.abs(value);
  return size >= 1e-3 && size < 1e5 ? String(Number(value.toPrecision(digits))) : value.toExponential(digits - 1);
}
