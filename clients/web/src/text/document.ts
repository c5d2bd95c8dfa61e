// SPDX-License-Identifier: GPL-3.0-or-later
// The texts of index.html. The file itself has only the words that are needed before the script runs.
import { byId } from '../panels/dom';
import { language, text } from './text';

/** Sets the language of the page and the accessible names of its elements. */
export function labelPage(): void {
  document.documentElement.lang = language;
  for (const [id, label] of Object.entries(text.page.labels)) byId(id).setAttribute('aria-label', label);
}
