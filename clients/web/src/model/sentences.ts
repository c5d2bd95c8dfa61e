// SPDX-License-Identifier: GPL-3.0-or-later
// Turns errors into sentences for users, without paths of members and expressions of programs.
import { text } from '../text/text';

export const NAME_RULE = text.sentences.nameRule;
const EXPRESSION = '[a-z]'; // part of the daemon's rule for names
const UNIT = /_(j_m2|j_k|w_k|j|w|v|a|m_s|m2_s|m2|m|c|pa|rad_s|rad|per_s|n_m|ns_m|n|nm|kg_m3|s)$/;

/** "hot_radius_m" as people say it: "Hot radius". Words of the catalogue come before words made of the name. */
export function memberWords(name: string): string {
  if (Object.hasOwn(text.sentences.members, name)) return text.sentences.members[name];
  const bare = name.replace(UNIT, '');
  return bare.charAt(0).toUpperCase() + bare.slice(1).replaceAll('_', ' ');
}

/** "J/m^2" as people write it: "J/m²". */
export function unitText(unit: string): string {
  return unit.replace('^2', '²').replace('^3', '³');
}

/** Returns the words with a capital letter at the beginning and a full stop at the end. */
export function sentence(words: string): string {
  const begun = words.charAt(0).toUpperCase() + words.slice(1);
  return /[.!?…]$/.test(begun) ? begun : `${begun}.`;
}

/** Returns the last member of a path such as params.layers[2].young_modulus_pa. */
function memberOf(path: string): string {
  return path.replace(/\[\d+\]/g, '').split('.').filter((member) => member !== 'params').at(-1) ?? '';
}

export function errorWords(error: unknown): string {
  const words = error instanceof Error ? error.message : String(error);
  if (words.includes(EXPRESSION)) return sentence(NAME_RULE);
  const path = error instanceof Error && 'path' in error && typeof error.path === 'string' ? error.path : '';
  const member = memberOf(path);
  return member === '' ? sentence(words) : sentence(`${memberWords(member)}: ${words}`);
}

/** Returns a message about a mesh file in the words of the upload form. */
export function meshWords(words: string): string {
  return words
    .replace(/\bunit_m ([0-9.]+(?:e[-+]?[0-9]+)?)/g, (_said, unit: string) => text.sentences.meshUnit(Number((1000 * Number(unit)).toPrecision(6))))
    .replace(/\(as (fat|fascia)\)/g, (_said, kind: 'fat' | 'fascia') => text.sentences.meshTissue[kind]);
}
