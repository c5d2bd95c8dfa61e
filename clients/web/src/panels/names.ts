// SPDX-License-Identifier: GPL-3.0-or-later
// Inputs for the names of sessions, tools and snapshots, with the rule for names in a sentence.
import { NAME_RULE } from '../model/sentences';
import { element } from './dom';

const NAME = /^[a-z][a-z0-9]*([_-][a-z0-9]+)*$/;

export function nameInput(props: { name: string; maxLength: number; required?: boolean; value?: string; placeholder?: string }): HTMLInputElement {
  const input = element('input', { autocomplete: 'off', spellcheck: false, ...props });
  input.addEventListener('input', () => input.setCustomValidity(input.value === '' || NAME.test(input.value) ? '' : `${NAME_RULE}.`));
  return input;
}
