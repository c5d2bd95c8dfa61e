// SPDX-License-Identifier: GPL-3.0-or-later
// Builds the manual: build.ts [FOLDER], by default clients/web/dist-manual. Exit code 1, and every reason, where a
// link leads nowhere, a formula is no TeX, or a public declaration has no comment.
import { cpSync, mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { stripTypeScriptTypes } from 'node:module';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { readInterfaces } from './api.ts';
import { frame, type Group } from './page.ts';
import { MANUAL, Site } from './site.ts';

const here = fileURLToPath(new URL('.', import.meta.url));
const root = join(here, '../../..');
const out = process.argv[2] ?? join(here, '../dist-manual');

interface Contents {
  title: string;
  pages: string[];
  folded?: boolean; // one line in the navigation of other pages
}

function groupsOf(contents: Contents[], site: Site): Group[] {
  return contents.map(({ title, pages, folded = false }) => ({
    title,
    folded,
    entries: pages.flatMap((path) => {
      const page = site.pages.get(path);
      return page ? [{ title: page.rendered.title, out: page.out }] : [];
    }),
  }));
}

function write(folder: string, name: string, text: string): void {
  const path = join(folder, name);
  mkdirSync(dirname(path), { recursive: true });
  writeFileSync(path, text);
}

const flat = (text: string): string => text.replace(/\s+/g, ' ').trim();

/** The index that search.ts reads. Files that are shown as they are, are not in it. */
function indexOf(site: Site): string {
  const pages = [...site.pages.values()].filter(({ path }) => path.endsWith('.md'));
  return JSON.stringify({
    pages: pages.map(({ rendered, out: address }) => [rendered.title, address]),
    sections: pages.flatMap(({ rendered }, page) => rendered.sections.map(({ anchor, title, text }) => [page, anchor, title, flat(text)])),
  });
}

function writeAll(site: Site, groups: Group[], folder: string): void {
  for (const page of site.pages.values()) {
    write(folder, page.out, frame(page.out, page.rendered.title, page.rendered.html, page.rendered.headings, groups));
  }
  for (const picture of site.pictures) cpSync(join(root, picture), join(folder, 'files', picture));
  write(folder, 'search.json', indexOf(site));
  write(folder, 'search.js', stripTypeScriptTypes(readFileSync(join(here, 'search.ts'), 'utf8')));
  cpSync(join(here, 'style.css'), join(folder, 'style.css'));
  cpSync(join(here, '../public/icon.svg'), join(folder, 'icon.svg'));
}

/** In place of what is there, whole or not at all. */
function replace(folder: string, fill: (folder: string) => void): void {
  const made = `${folder}.new`;
  rmSync(made, { recursive: true, force: true });
  fill(made);
  rmSync(folder, { recursive: true, force: true });
  renameSync(made, folder);
}

const interfaces = readInterfaces(root);
const contents = JSON.parse(readFileSync(join(root, MANUAL, 'contents.json'), 'utf8')) as Contents[];
const all = [...contents, { title: 'C interfaces', folded: true, pages: interfaces.pages.map(({ path }) => path) }];
const site = new Site(root, new Map(interfaces.pages.map(({ path, text }) => [path, text])), interfaces.stands);
site.add(all.flatMap(({ pages }) => pages));
const errors = [...interfaces.errors, ...site.errors];
if (errors.length > 0) {
  process.stderr.write(`${errors.join('\n')}\nThe manual is not built: ${errors.length} errors\n`);
  process.exit(1);
}
replace(out, (folder) => writeAll(site, groupsOf(all, site), folder));
process.stdout.write(`${site.pages.size} pages, ${site.pictures.size} pictures, ${interfaces.note}: ${out}\n`);
