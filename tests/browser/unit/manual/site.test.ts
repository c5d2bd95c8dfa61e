// SPDX-License-Identifier: GPL-3.0-or-later
// Tests which pages the manual has, and that a broken link prevents its build.
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';

import { relative } from '../../../../clients/web/manual/page.ts';
import { outOf, Site } from '../../../../clients/web/manual/site.ts';

const root = mkdtempSync(join(tmpdir(), 'cautery-manual-'));
afterAll(() => rmSync(root, { recursive: true }));

function site(files: Record<string, string>): Site {
  for (const [name, text] of Object.entries(files)) {
    mkdirSync(dirname(join(root, name)), { recursive: true });
    writeFileSync(join(root, name), text);
  }
  const made = new Site(root, new Map([['api/a.md', '# cautery/a.h\n']]), new Map([['core/a.h', 'api/a.md']]));
  made.add(['deploy/manual/index.md']);
  return made;
}

describe('the manual', () => {
  it('has what its pages link: pages, sources, pictures, folders, headers', () => {
    const { pages, pictures, errors } = site({
      'deploy/manual/index.md': '# Start\n\n[core](../../core/), [code](../../core/b.c), [a header](../../core/a.h#cauteryah), ![it](it.svg), [out](https://example.org)\n',
      'deploy/manual/it.svg': '<svg/>', 'core/README.md': '# Core\n\n[back](../deploy/manual/index.md#start)\n', 'core/b.c': 'int b;\n', 'core/a.h': 'int a;\n',
    });
    expect(errors).toEqual([]);
    expect([...pages.values()].map(({ out }) => out).sort()).toEqual(['api/a.html', 'design/core/README.html', 'index.html', 'source/core/b.c.html']);
    expect([...pictures]).toEqual(['deploy/manual/it.svg']);
    expect(pages.get('core/README.md')!.rendered.html).toMatch('href="../../index.html#start"');
  });

  it.each([
    ['[no](nothing.txt)', /links nothing.txt, which does not exist/],
    ['[no](#nothing)', /no such heading/],
    ['[no](../../core/README.md#nothing)', /no such heading/],
    ['![no](nothing.png)', /which does not exist/],
    ['[no](../../../outside.md)', /which does not exist/],
  ])('is not built with %s', (link, reason) => {
    const { errors } = site({ 'deploy/manual/index.md': `# Start\n\n${link}\n`, 'core/README.md': '# Core\n' });
    expect(errors).toHaveLength(1);
    expect(errors[0]).toMatch(reason);
  });

  it('is not built with a page without a heading', () => {
    expect(site({ 'deploy/manual/index.md': 'only text\n' }).errors).toEqual(['deploy/manual/index.md: no heading']);
  });

  it('has no folder that begins with a dot, because the daemon serves none', () => {
    expect(outOf('.github/SECURITY.md')).toBe('design/github/SECURITY.html');
  });

  it.each([['index.html', 'a/b.html', 'a/b.html'], ['a/b.html', 'index.html', '../index.html'], ['a/b/c.html', 'a/d/e.html', '../d/e.html']])(
    'leads from %s to %s', (from, to, way) => expect(relative(from, to)).toBe(way));
});
