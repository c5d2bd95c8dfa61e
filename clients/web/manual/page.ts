// SPDX-License-Identifier: GPL-3.0-or-later
// The frame around a page: navigation, search field, headings of the page.
import { escape, type Heading } from './markdown.ts';

export interface Entry {
  title: string;
  out: string; // address from the manual's top
}
export interface Group {
  title: string;
  entries: Entry[];
  folded?: boolean; // only its first entry is shown, except on its own pages
}

/** The way from one page's folder to another file of the manual. */
export function relative(from: string, to: string): string {
  const [here, there] = [from.split('/').slice(0, -1), to.split('/')];
  while (here.length > 0 && there.length > 1 && here[0] === there[0]) {
    here.shift();
    there.shift();
  }
  return '../'.repeat(here.length) + there.join('/');
}

function navigation(groups: Group[], out: string): string {
  const item = (entry: Entry): string => {
    const current = entry.out === out ? ' aria-current="page"' : '';
    return `<li><a href="${relative(out, entry.out)}"${current}>${escape(entry.title)}</a></li>`;
  };
  const shown = ({ entries, folded }: Group): Entry[] => (folded === true && !entries.some((entry) => entry.out === out) ? entries.slice(0, 1) : entries);
  return groups.map((group) => `<h2>${escape(group.title)}</h2>\n<ul>\n${shown(group).map(item).join('\n')}\n</ul>`).join('\n');
}

const LEAST_HEADINGS = 4; // fewer are seen at a glance

function onThisPage(headings: Heading[]): string {
  const shown = headings.filter((heading) => heading.level === 2);
  if (shown.length < LEAST_HEADINGS) return '';
  const items = shown.map((heading) => `<li><a href="#${heading.anchor}">${escape(heading.text)}</a></li>`);
  return `<nav class="on-this-page" aria-label="On this page">\n<ul>\n${items.join('\n')}\n</ul>\n</nav>\n`;
}

export function frame(out: string, title: string, html: string, headings: Heading[], groups: Group[]): string {
  const top = relative(out, 'index.html');
  return `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>${escape(title)} - Cautery</title>
<link rel="icon" href="${relative(out, 'icon.svg')}">
<link rel="stylesheet" href="${relative(out, 'style.css')}">
<script type="module" src="${relative(out, 'search.js')}"></script>
</head>
<body>
<a class="skip" href="#page">Skip to the page</a>
<header>
<a class="home" href="${top}">Cautery manual</a>
<form role="search" id="search" data-index="${relative(out, 'search.json')}" data-top="${top.slice(0, -'index.html'.length)}" hidden>
<label for="words">Search</label>
<input id="words" type="search" autocomplete="off" spellcheck="false">
</form>
</header>
<div class="columns">
<nav class="pages" aria-label="Pages">
${navigation(groups, out)}
</nav>
<main id="page">
<section id="found" aria-live="polite" hidden></section>
<article>
${onThisPage(headings)}${html}
</article>
</main>
</div>
</body>
</html>
`;
}
