// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a page of the manual as HTML that a strict Content-Security-Policy allows.
import { mathematics, render } from '../../../../clients/web/manual/markdown.ts';

const same = (link: string): string => link;

describe('a page', () => {
  it('has no style attribute, neither of aligned cells nor of formulas', () => {
    const { html } = render('# A\n\n| a | b |\n|--:|:-:|\n| 1 | 2 |\n\n```math\n\\begin{bmatrix} a & b \\\\ c & d \\end{bmatrix}\n```\n', same);
    expect(html).not.toMatch(/style/);
    expect(html).toMatch(/<td class="to-right">1/);
    expect(html).toMatch(/<mtable/);
  });

  it('numbers equations, and gives them anchors', () => {
    const { html, anchors } = render('# A\n\n```math\na = b \\tag{4}\n```\n', same);
    expect(html).toMatch(/<div class="equation" id="eq-4">.*<span class="number">\(4\)<\/span>/);
    expect(anchors.has('eq-4')).toBe(true);
  });

  it('takes formulas within a sentence, and leaves code and dollars alone', () => {
    const { html } = render('# A\n\nWith $`\\alpha`$ it costs 3 $, and `$HOME` is code.\n', same);
    expect(html).toMatch(/With <math.*α.*<\/math> it costs 3 \$, and <code>\$HOME<\/code>/);
  });

  it('refuses TeX that is none, and raw HTML', () => {
    expect(() => mathematics('\\frac{a', true)).toThrow();
    expect(() => render('# A\n\n<script>alert(1)</script>\n', same)).toThrow(/raw HTML/);
    expect(() => render('# A\n\nSee <b onclick="x">this</b>.\n', same)).toThrow(/raw HTML/);
  });

  it('gives headings the anchors that GitHub gives them', () => {
    const { anchors } = render('# The `one`: a, b\n\n## Twice\n\n## Twice\n', same);
    expect([...anchors]).toEqual(['the-one-a-b', 'twice', 'twice-1']);
  });

  it('keeps the text of a link that leads nowhere', () => {
    const { html } = render('# A\n\n[a folder](b/) and [a page](c.txt).\n', (link) => (link === 'b/' ? undefined : 'c.html'));
    expect(html).toMatch(/<p>a folder and <a href="c.html">a page<\/a>\./);
  });

  it('is divided into sections for the search', () => {
    const { sections } = render('# A\n\nfirst\n\n## B\n\nsecond `code`\n\n    shell\n', same);
    expect(sections.map(({ title, text }) => [title, text.trim().replace(/\s+/g, ' ')])).toEqual([['A', 'first'], ['B', 'second code shell']]);
  });
});
