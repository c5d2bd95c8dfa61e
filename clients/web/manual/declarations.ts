// SPDX-License-Identifier: GPL-3.0-or-later
// What the public headers declare, as the compiler sees it: clang's syntax tree, with every comment taken for
// documentation. So no second parser of C has to be right, and macros are expanded.
import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

export interface Declaration {
  name: string; // of a member: "cau_frame.tick"
  header: string; // in the repository
  offset: number; // of the name, in bytes
  documented: boolean;
  top: boolean; // no member of another declaration
}

interface Place {
  offset?: number;
  file?: string;
  spellingLoc?: Place;
  expansionLoc?: Place;
}
interface Node {
  kind: string;
  name?: string;
  loc?: Place;
  range?: { begin: Place; end: Place };
  inner?: Node[];
}

const FOLDERS = ['core/include', 'core/types', 'clients/include', 'protocol/include'];
const TREE_BYTES = 256 << 20; // many times what it has

/** The tree names a file only where it is another one than before, so that all of it is followed in order. */
class Files {
  private file = '';

  at(place: Place | undefined): { file: string; offset: number; generated: boolean } {
    if (place?.spellingLoc?.file !== undefined) this.file = place.spellingLoc.file;
    const written = place?.expansionLoc ?? place;
    if (written?.file !== undefined) this.file = written.file;
    return { file: this.file, offset: written?.offset ?? 0, generated: place?.expansionLoc !== undefined };
  }
}

const isCommented = (node: Node): boolean => node.inner?.some(({ kind }) => kind === 'FullComment') === true;
const MEMBERS = new Set(['FieldDecl', 'EnumConstantDecl']);
const KINDS = new Set(['FunctionDecl', 'RecordDecl', 'EnumDecl', 'TypedefDecl', ...MEMBERS]);
/** How many entries a table has: its name says it. */
const COUNT = /_COUNT$/;

function follow(node: Node, root: string, files: Files, owner: string, found: Declaration[]): void {
  const { file, offset, generated } = files.at(node.loc);
  files.at(node.range?.begin);
  files.at(node.range?.end);
  const isMember = MEMBERS.has(node.kind);
  const name = node.name ?? '';
  if (KINDS.has(node.kind) && file.startsWith(`${root}/`) && file.endsWith('.h') && name !== '' && !name.startsWith('__')) {
    // What a table's macro makes is documented by the table's words.
    const documented = isCommented(node) || generated || (node.kind === 'EnumConstantDecl' && COUNT.test(name));
    found.push({ name: isMember && owner ? `${owner}.${name}` : name, header: file.slice(root.length + 1), offset, documented, top: !isMember });
  }
  const inner = node.kind === 'RecordDecl' || node.kind === 'EnumDecl' ? name : '';
  for (const each of node.inner ?? []) follow(each, root, files, inner, found);
}

/** clang takes a comment behind a member for its own, and one behind a function for nobody's. */
function isFollowedByComment({ header, offset }: Declaration, root: string): boolean {
  return /^[^;{]*;[ \t]*\/\//.test(readFileSync(join(root, header)).subarray(offset).toString());
}

/** A struct and its typedef are one: documented where either is. */
function unite(found: Declaration[]): Declaration[] {
  const united = new Map<string, Declaration>();
  for (const each of found) {
    const key = `${each.header} ${each.name}`;
    const before = united.get(key);
    united.set(key, before ? { ...before, documented: before.documented || each.documented } : each);
  }
  return [...united.values()];
}

/** undefined where there is no clang. An error is what clang says of the headers. */
export function declarations(root: string, headers: string[]): Declaration[] | undefined {
  const source = headers.map((header) => `#include "${join(root, header)}"\n`).join('');
  const flags = FOLDERS.map((folder) => `-I${join(root, folder)}`);
  const run = spawnSync('clang', ['-x', 'c', '-std=c11', '-fsyntax-only', '-fparse-all-comments', ...flags, '-Xclang', '-ast-dump=json', '-'],
    { input: source, encoding: 'utf8', maxBuffer: TREE_BYTES });
  if ((run.error as NodeJS.ErrnoException | undefined)?.code === 'ENOENT') return undefined;
  if (run.status !== 0) throw new Error(`clang cannot read the public headers: ${run.error?.message ?? run.stderr}`);
  const found: Declaration[] = [];
  follow(JSON.parse(run.stdout) as Node, root, new Files(), '', found);
  return unite(found).map((each) => ({ ...each, documented: each.documented || (each.top && isFollowedByComment(each, root)) }));
}
