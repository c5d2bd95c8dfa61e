// SPDX-License-Identifier: GPL-3.0-or-later
// One page of Markdown to HTML that a strict Content-Security-Policy lets through: no script, no style attribute,
// no handler. Mathematics becomes MathML here, so that the reader's browser runs nothing for it.
import makeMarkdown, { type MarkdownIt, type Token } from 'markdown-it';
import temml from 'temml';

export interface Heading {
  level: number;
  text: string;
  anchor: string;
}

/** A section of a page for the search: what stands between two headings. */
export interface Section {
  anchor: string; // empty: the page's beginning
  title: string;
  text: string;
}

export interface Rendered {
  html: string;
  title: string; // of the first heading
  headings: Heading[];
  sections: Section[];
  anchors: Set<string>; // of headings and of equations
}

/** Where a link of the page leads in the manual; undefined: nowhere, and its text alone is kept. */
export type Resolve = (link: string) => string | undefined;

export const escape = (text: string): string =>
  text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;').replace(/"/g, '&quot;');

/** The anchor of a heading, as GitHub makes it: links of the pages work there and here. */
export function slug(text: string): string {
  return text.replace(/`/g, '').toLowerCase().replace(/[^\p{L}\p{N}_\- ]/gu, '').replace(/ /g, '-');
}

/** TeX to MathML. A mistake in the TeX is an error. Style attributes are left out: only fine spacing depends on them. */
export function mathematics(tex: string, displayed: boolean): string {
  return temml.renderToString(tex, { displayMode: displayed, throwOnError: true }).replace(/ style="[^"]*"/g, '');
}

/** A block of TeX. `\tag{4}` numbers it, and makes the anchor `eq-4`. */
function equation(tex: string): string {
  const tags = [...tex.matchAll(/\\tag\{([^}]+)\}/g)].map((found) => found[1]);
  const body = mathematics(tex.replace(/\\tag\{[^}]+\}/g, ''), true);
  const number = tags.length > 0 ? `<span class="number">(${escape(tags.join(', '))})</span>` : '';
  return `<div class="equation"${tags.length > 0 ? ` id="eq-${slug(tags[0])}"` : ''}>${body}${number}</div>\n`;
}

/** Raw HTML that pages may have: comments, which are left out, and pictures with a size. */
function picture(html: string, resolve: Resolve): string {
  if (/^<!--[^]*-->$/.test(html.trim())) return '';
  const found = /^<img src="([^"]+)" alt="([^"]*)"(?: width="(\d+)")?>$/.exec(html.trim());
  if (found === null) throw new Error(`raw HTML other than <img src alt width>: ${html.trim().slice(0, 60)}`);
  return `<img src="${escape(resolve(found[1]) ?? '')}" alt="${escape(found[2])}"${found[3] ? ` width="${found[3]}"` : ''}>`;
}

function textOf(children: Token[]): string {
  return children.map((child) => (child.type === 'softbreak' ? ' ' : child.content)).join('');
}

function addAnchor(token: Token, text: string, seen: Map<string, number>): string {
  const base = slug(text);
  const times = seen.get(base) ?? 0;
  seen.set(base, times + 1);
  const anchor = times > 0 ? `${base}-${times}` : base;
  token.attrSet('id', anchor);
  return anchor;
}

/** Links lead to pages of the manual. One that leads nowhere keeps its text and loses its mark. */
function resolveLinks(children: Token[], resolve: Resolve): void {
  let dropped = false;
  for (const token of children) {
    if (token.type === 'link_open') {
      const to = resolve(String(token.attrGet('href') ?? ''));
      dropped = to === undefined;
      if (to !== undefined) token.attrSet('href', to);
    } else if (token.type === 'image') {
      token.attrSet('src', resolve(String(token.attrGet('src') ?? '')) ?? '');
    }
    if (dropped && (token.type === 'link_open' || token.type === 'link_close')) {
      if (token.type === 'link_close') dropped = false;
      token.type = 'html_inline';
      token.content = '';
    }
  }
}

function findMathematics(children: Token[]): void {
  for (const [at, token] of children.entries()) {
    const [before, after] = [children[at - 1], children[at + 1]];
    if (token.type !== 'code_inline' || !before?.content.endsWith('$') || !after?.content.startsWith('$')) continue;
    before.content = before.content.slice(0, -1);
    after.content = after.content.slice(1);
    token.type = 'math_inline';
  }
}

function alignWithClasses(token: Token): void {
  const found = /text-align:(\w+)/.exec(String(token.attrGet('style') ?? ''));
  if (found === null) return;
  token.attrs = (token.attrs ?? []).filter(([name]) => name !== 'style');
  token.attrJoin('class', `to-${found[1]}`);
}

function make(resolve: Resolve): MarkdownIt {
  const md = makeMarkdown({ html: true });
  const { fence } = md.renderer.rules;
  md.renderer.rules.fence = (tokens, at, options, env, self) =>
    tokens[at].info.trim() === 'math' ? equation(tokens[at].content) : fence(tokens, at, options, env, self);
  md.renderer.rules.math_inline = (tokens, at) => mathematics(tokens[at].content, false);
  md.renderer.rules.html_block = (tokens, at) => `<p>${picture(tokens[at].content, resolve)}</p>\n`;
  md.renderer.rules.html_inline = (tokens, at) => (tokens[at].content === '' ? '' : picture(tokens[at].content, resolve));
  md.renderer.rules.table_open = () => '<div class="table"><table>\n';
  md.renderer.rules.table_close = () => '</table></div>\n';
  return md;
}

export function render(source: string, resolve: Resolve): Rendered {
  const md = make(resolve);
  const tokens = md.parse(source, {});
  const seen = new Map<string, number>();
  const [headings, sections]: [Heading[], Section[]] = [[], [{ anchor: '', title: '', text: '' }]];
  for (const [at, token] of tokens.entries()) {
    alignWithClasses(token);
    if (token.type === 'inline') {
      const opened = tokens[at - 1];
      const text = textOf(token.children ?? []);
      findMathematics(token.children ?? []);
      resolveLinks(token.children ?? [], resolve);
      if (opened?.type === 'heading_open') {
        const heading = { level: Number(opened.tag.slice(1)), text: text.replace(/`/g, ''), anchor: addAnchor(opened, text, seen) };
        headings.push(heading);
        sections.push({ anchor: heading.anchor, title: heading.text, text: '' });
        continue;
      }
      sections[sections.length - 1].text += `${text} `;
    } else if (token.type === 'fence' || token.type === 'code_block') {
      sections[sections.length - 1].text += `${token.content.slice(0, 400)} `;
    }
  }
  const html = md.renderer.render(tokens, md.options, {});
  const anchors = new Set([...html.matchAll(/ id="([^"]+)"/g)].map((found) => found[1]));
  const title = headings[0]?.text ?? '';
  return { html, title, headings, sections: sections.filter((section) => section.text.trim() !== ''), anchors };
}
