// SPDX-License-Identifier: GPL-3.0-or-later
// The manual's search, in the reader's browser: an index of sections is fetched at the first word, and every word
// that was typed must begin a word of the section or of its titles.
interface Found {
  page: number;
  anchor: string;
  title: string;
  text: string;
}
interface Index {
  pages: [title: string, out: string][];
  sections: [page: number, anchor: string, title: string, text: string][];
}

const MOST_RESULTS = 30;
const AROUND = 80; // characters of text before and after a word that was found
const [IN_TITLE, IN_PAGE, IN_TEXT] = [8, 4, 1]; // weights: who types a heading's word looks for that heading

const form = document.querySelector<HTMLFormElement>('#search')!;
const field = form.querySelector('input')!;
const shown = document.querySelector<HTMLElement>('#found')!;
const article = document.querySelector<HTMLElement>('article')!;
let loading: Promise<Index> | undefined;

async function load(): Promise<Index> {
  const answer = await fetch(form.dataset['index']!);
  if (!answer.ok) throw new Error(`the index could not be read: ${answer.status}`);
  return (await answer.json()) as Index;
}

const wordsOf = (text: string): string[] => text.toLowerCase().match(/[\p{L}\p{N}_]+/gu) ?? [];
const begins = (words: string[], word: string): number => words.filter((each) => each.startsWith(word)).length;

/** 0 where a word is missing. */
function score(section: Found, page: string, words: string[]): number {
  const [title, pageTitle, text] = [wordsOf(section.title), wordsOf(page), wordsOf(section.text)];
  let sum = 0;
  for (const word of words) {
    const here = IN_TITLE * Math.min(begins(title, word), 1) + IN_PAGE * Math.min(begins(pageTitle, word), 1) + IN_TEXT * Math.min(begins(text, word), 3);
    if (here === 0) return 0;
    sum += here;
  }
  return sum;
}

function excerpt(text: string, word: string): string {
  const at = Math.max(text.toLowerCase().indexOf(word), 0);
  const [from, to] = [Math.max(at - AROUND, 0), at + AROUND];
  return `${from > 0 ? '… ' : ''}${text.slice(from, to).trim()}${to < text.length ? ' …' : ''}`;
}

function item(index: Index, section: Found, word: string): HTMLElement {
  const [title, out] = index.pages[section.page];
  const [entry, link, text] = [document.createElement('li'), document.createElement('a'), document.createElement('p')];
  link.href = `${form.dataset['top']}${out}${section.anchor ? `#${section.anchor}` : ''}`;
  link.textContent = section.title && section.title !== title ? `${title}: ${section.title}` : title;
  link.addEventListener('click', () => show(false)); // it may lead within this page
  text.textContent = excerpt(section.text, word);
  entry.append(link, text);
  return entry;
}

function show(results: boolean): void {
  shown.hidden = !results;
  article.hidden = results;
}

async function search(): Promise<void> {
  const words = wordsOf(field.value);
  if (words.length === 0) {
    show(false);
    return;
  }
  const index = await (loading ??= load());
  if (wordsOf(field.value).join(' ') !== words.join(' ')) return; // more was typed meanwhile
  const found = index.sections
    .map(([page, anchor, title, text]): Found => ({ page, anchor, title, text }))
    .map((section) => ({ section, sum: score(section, index.pages[section.page][0], words) }))
    .filter(({ sum }) => sum > 0)
    .sort((a, b) => b.sum - a.sum)
    .slice(0, MOST_RESULTS);
  const [heading, list] = [document.createElement('h1'), document.createElement('ol')];
  heading.textContent = found.length > 0 ? `Found for “${field.value.trim()}”` : `Nothing found for “${field.value.trim()}”`;
  list.append(...found.map(({ section }) => item(index, section, words[0])));
  shown.replaceChildren(heading, list);
  show(true);
}

function complain(error: unknown): void {
  loading = undefined;
  shown.textContent = `The search does not work: ${error instanceof Error ? error.message : String(error)}. Reload the page.`;
  show(true);
}

form.hidden = false; // without scripts there is no field that does nothing
field.addEventListener('input', () => void search().catch(complain));
form.addEventListener('submit', (event) => {
  event.preventDefault();
  shown.querySelector('a')?.click();
});
