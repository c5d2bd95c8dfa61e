// SPDX-License-Identifier: GPL-3.0-or-later
// Tests which declarations of public headers are found, and which of them have no comment.
import { spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { declarations } from '../../../../clients/web/manual/declarations.ts';

const HEADER = `// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A pair.
typedef struct cau_pair {
	int first; // m
	int second, third;
	// Both of these.
	int fourth, fifth;
} cau_pair;

typedef struct cau_bare cau_bare;

// Adds.
int cau_add(int a, int b);
int cau_other(int a);
void cau_third(void); // does nothing

#define TABLE(X) X(ONE) X(TWO)
// Ways.
typedef enum cau_way {
#define X(name) CAU_WAY_##name,
	TABLE(X)
#undef X
		CAU_WAY_COUNT
} cau_way;
enum { CAU_LIMIT_ONE = 1, CAU_LIMIT_TWO = 2 }; // of both
`;

const withClang = spawnSync('clang', ['--version']).status === 0 ? describe : describe.skip;
withClang('the declarations of a header', { timeout: 60_000 }, () => { // clang, on a busy machine
  const root = mkdtempSync(join(tmpdir(), 'cautery-header-'));
  mkdirSync(join(root, 'core/include'), { recursive: true });
  const of = (text: string): ReturnType<typeof declarations> => {
    writeFileSync(join(root, 'core/include/a.h'), text);
    return declarations(root, ['core/include/a.h']);
  };
  afterAll(() => rmSync(root, { recursive: true }));

  it('are known with their comments', () => {
    const found = of(HEADER)!;
    const bare = found.filter(({ documented }) => !documented).map(({ name }) => name);
    expect(bare).toEqual(['cau_pair.second', 'cau_pair.third', 'cau_bare', 'cau_other']);
    expect(found.map(({ name }) => name)).toContain('cau_way.CAU_WAY_TWO');
    const add = found.find(({ name }) => name === 'cau_add')!;
    expect(HEADER.slice(add.offset, add.offset + 7)).toBe('cau_add');
  });

  it('are an error where the header is no C', () => {
    expect(() => of('int cau_add(;\n')).toThrow(/clang cannot read/);
  });
});
