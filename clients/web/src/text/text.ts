// SPDX-License-Identifier: GPL-3.0-or-later
// The page's language. A further language is a file beside en.ts that has the type of `en`, and an entry here.
// Messages of the daemon and of the wire library are English in every language.
import { en } from './en';

export type Text = typeof en;

const LANGUAGES: Readonly<Record<string, Text>> = { en };

/** Returns the first language of the browser that the page has; otherwise English. */
function languageOf(wanted: readonly string[]): string {
  return wanted.map((tag) => tag.split('-')[0]).find((language) => Object.hasOwn(LANGUAGES, language)) ?? 'en';
}

export const language = languageOf(globalThis.navigator?.languages ?? []);
export const text = LANGUAGES[language];
