// SPDX-License-Identifier: GPL-3.0-or-later
// Which files the manual has: the pages of its table of contents, and whatever these link, and so on. A link that
// leads nowhere is an error, so the built manual has no broken link.
import { existsSync, readFileSync, statSync } from 'node:fs';
import { dirname, join, normalize } from 'node:path/posix';

import { render, type Rendered, type Resolve } from './markdown.ts';
import { relative } from './page.ts';

export const MANUAL = 'deploy/manual';
const PICTURE = /\.(png|svg|jpg|webp)$/;
const ELSEWHERE = /^[a-z]+:/; // https:, mailto:

export interface Page {
  path: string; // in the repository
  out: string; // address from the manual's top
  rendered: Rendered;
}

/** Where a file of the repository stands in the manual. */
export function outOf(path: string): string {
  if (PICTURE.test(path)) return `files/${path}`;
  if (!path.endsWith('.md')) return `source/${path}.html`;
  if (path.startsWith('api/')) return path.replace(/\.md$/, '.html');
  if (path.startsWith(`${MANUAL}/`)) return path.slice(MANUAL.length + 1).replace(/\.md$/, '.html');
  return `design/${path.replace(/\.md$/, '.html').replace(/^\./, '')}`; // the daemon serves no hidden folder
}

/** A file that is not a page, shown as it is. */
function asPage(path: string, text: string): string {
  const fence = '`'.repeat(Math.max(3, ...[...text.matchAll(/`+/g)].map((found) => found[0].length + 1)));
  return `# ${path}\n\n${fence}\n${text}${text.endsWith('\n') ? '' : '\n'}${fence}\n`;
}

export class Site {
  readonly pages = new Map<string, Page>();
  readonly pictures = new Set<string>();
  readonly errors: string[] = [];
  private readonly root: string;
  private readonly made: Map<string, string>;
  private readonly stands: Map<string, string>;
  private readonly wanted: string[] = [];
  private readonly anchored: { from: string; to: string; anchor: string }[] = [];

  /** `made`: pages that no file holds, by path; `stands`: the page that stands for a file, by the file's path. */
  constructor(root: string, made: Map<string, string>, stands: Map<string, string>) {
    [this.root, this.made, this.stands] = [root, made, stands];
  }

  add(paths: string[]): void {
    this.wanted.push(...paths);
    for (let path = this.wanted.shift(); path !== undefined; path = this.wanted.shift()) {
      if (!this.pages.has(path)) this.read(path);
    }
    this.checkAnchors();
  }

  private read(path: string): void {
    const text = this.made.get(path) ?? this.file(path);
    if (text === undefined) return;
    try {
      const rendered = render(path.endsWith('.md') ? text : asPage(path, text), this.resolverOf(path));
      this.pages.set(path, { path, out: outOf(path), rendered });
      if (rendered.title === '') this.errors.push(`${path}: no heading`);
    } catch (error) {
      this.errors.push(`${path}: ${error instanceof Error ? error.message : String(error)}`);
    }
  }

  private file(path: string): string | undefined {
    const name = join(this.root, path);
    if (existsSync(name) && statSync(name).isFile()) return readFileSync(name, 'utf8');
    this.errors.push(`${path}: no such file`);
    return undefined;
  }

  /** The file that a link means: a folder's is its README. undefined for a folder without one. */
  private target(from: string, path: string): string | undefined {
    const to = path === '' ? from : normalize(join(dirname(from), path)).replace(/\/$/, '');
    const stands = this.stands.get(to) ?? to;
    if (this.made.has(stands)) return stands;
    const name = join(this.root, to);
    if (!to.startsWith('..') && existsSync(name)) {
      if (!statSync(name).isDirectory()) return to;
      return existsSync(join(name, 'README.md')) ? join(to, 'README.md') : undefined;
    }
    this.errors.push(`${from}: links ${path}, which does not exist`);
    return undefined;
  }

  private resolverOf(from: string): Resolve {
    return (link) => {
      if (ELSEWHERE.test(link)) return link;
      const [path, anchor] = link.split('#');
      const to = this.target(from, decodeURI(path));
      if (to === undefined) return undefined;
      if (PICTURE.test(to)) this.pictures.add(to);
      else this.wanted.push(to);
      if (anchor !== undefined) this.anchored.push({ from, to, anchor });
      const way = to === from ? '' : relative(outOf(from), outOf(to));
      return anchor === undefined ? way : `${way}#${anchor}`;
    };
  }

  private checkAnchors(): void {
    for (const { from, to, anchor } of this.anchored) {
      const page = this.pages.get(to);
      if (page && !page.rendered.anchors.has(anchor)) this.errors.push(`${from}: links ${to}#${anchor}, and there is no such heading`);
    }
  }
}
