// SPDX-License-Identifier: GPL-3.0-or-later
// The reference of the C interfaces: a page for each public header, with its own comments and declarations. A
// declaration without a comment is an error.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

import { declarations, type Declaration } from './declarations.ts';

export interface Interfaces {
  pages: { path: string; text: string }[];
  stands: Map<string, string>; // the page of each header
  errors: string[];
  note: string;
}

/** Shown in this order: folder, and what stands there. */
const ROOMS = [
  ['core/include/cautery', 'the core'],
  ['core/types/cautery', 'types that the core shares with the protocol'],
  ['clients/include/cautery', 'the client library'],
  ['protocol/include/cautery', 'the protocol'],
] as const;

/** A comment with what it is about; `code` is empty for a comment that stands alone. */
interface Block {
  comment: string[];
  code: string[];
  from: number; // bytes
  to: number;
}

const RULE = /^-{4,} ?(.*?) ?-*$/; // "---- life ----"
const isComment = (line: string): boolean => line.startsWith('//');
const isHidden = (line: string): boolean => /^#(include|pragma|ifdef __cplusplus)|clang-format/.test(line);

/** Blocks end at a blank line outside braces, and where a comment begins after code. */
function blocksOf(text: string): Block[] {
  const blocks: Block[] = [];
  let [at, depth] = [0, 0];
  let block: Block = { comment: [], code: [], from: 0, to: 0 };
  const close = (): void => {
    if (block.comment.length > 0 || block.code.length > 0) blocks.push({ ...block, to: at });
    block = { comment: [], code: [], from: at, to: at };
  };
  for (const line of text.split('\n')) {
    if (depth === 0 && (line === '' || (isComment(line) && block.code.length > 0))) close();
    if (isComment(line) && depth === 0 && RULE.test(line.slice(3))) close();
    if (!(depth === 0 && (line === '' || isHidden(line)))) (isComment(line) && block.code.length === 0 ? block.comment : block.code).push(line);
    const code = line.replace(/\/\/.*|\/\*.*?\*\/|"[^"]*"/g, '');
    depth += (code.match(/\{/g)?.length ?? 0) - (code.match(/\}/g)?.length ?? 0);
    at += Buffer.byteLength(line) + 1;
  }
  close();
  return blocks;
}

/** Lines of a comment as Markdown: what is indented is an example or a table, and stays as it is. */
function proseOf(comment: string[]): string {
  return comment
    .map((line) => line.slice(3))
    .map((line) => (line.startsWith('    ') || line === '' ? line : line.replace(/\b(cau_\w+|CAU_\w+)(\(\))?/g, '`$&`').replace(/``/g, '`').replace(/\*(?=[`\w])|</g, '\\$&')))
    .map((line, at, lines) => (line.startsWith('    ') && at > 0 && lines[at - 1] !== '' && !lines[at - 1].startsWith('    ') ? `\n${line}` : line))
    .join('\n');
}

const fenced = (code: string[]): string => `\`\`\`c\n${code.join('\n')}\n\`\`\``;

function shown(block: Block, declared: Declaration[]): string {
  const rule = RULE.exec(block.comment[0]?.slice(3) ?? '');
  const section = rule ? `## ${rule[1].charAt(0).toUpperCase()}${rule[1].slice(1)}\n\n` : '';
  const prose = proseOf(rule ? block.comment.slice(1) : block.comment);
  if (block.code.length === 0) return section + prose;
  const macros = block.code.flatMap((line) => /^#define (CAU_\w+)/.exec(line)?.[1] ?? []);
  const names = [...new Set([...declared.filter(({ top, offset }) => top && offset >= block.from && offset < block.to).map(({ name }) => name), ...macros])];
  const heading = names.length > 0 ? `### ${names.map((name) => `\`${name}\``).join(', ')}\n\n` : '';
  return `${section}${heading}${prose}\n\n${fenced(block.code)}`;
}

function pageOf(header: string, text: string, declared: Declaration[]): string {
  const [first, ...blocks] = blocksOf(text);
  const about = proseOf(first.comment.filter((line) => !line.includes('SPDX')));
  return [`# ${header.replace(/^.*\/(?=cautery\/)/, '')}`, about, ...blocks.map((block) => shown(block, declared))].join('\n\n');
}

function overview(root: string, headers: Map<string, string[]>): string {
  const line = (header: string): string => {
    const first = readFileSync(join(root, header), 'utf8').split('\n').find((each) => each.startsWith('// ') && !each.includes('SPDX')) ?? '';
    return `- [${header.split('/').slice(-1)[0]}](${pathOf(header).slice('api/'.length)}): ${proseOf([first]).replace(/[.:]?$/, '')}`;
  };
  const rooms = [...headers].map(([title, names]) => `## ${title.charAt(0).toUpperCase()}${title.slice(1)}\n\n${names.map(line).join('\n')}`);
  return ['# C interfaces', 'Each page is made from a public header, and every function, type and member has a comment there.', ...rooms].join('\n\n');
}

const pathOf = (header: string): string => `api/${header.split('/').slice(-1)[0].replace(/\.h$/, '')}.md`;

/** `root`: the repository. Without clang there are no pages, and the note says so. */
export function readInterfaces(root: string): Interfaces {
  const headers = new Map(ROOMS.map(([folder, title]) => [title, readdirSync(join(root, folder)).filter((name) => name.endsWith('.h')).sort().map((name) => `${folder}/${name}`)]));
  const all = [...headers.values()].flat();
  const declared = declarations(root, all);
  if (declared === undefined) return { pages: [], stands: new Map(), errors: [], note: 'no C interfaces, because clang is not installed' };
  const errors = declared.filter(({ documented }) => !documented).map(({ header, name }) => `${header}: ${name} has no comment`);
  const pages = all.map((header) => {
    const text = readFileSync(join(root, header), 'utf8');
    return { path: pathOf(header), text: pageOf(header, text, declared.filter((each) => each.header === header)) };
  });
  return {
    pages: [{ path: 'api/index.md', text: overview(root, headers) }, ...pages],
    stands: new Map(all.map((header) => [header, pathOf(header)])),
    errors,
    note: `${declared.length} C declarations`,
  };
}
