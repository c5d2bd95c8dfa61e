// SPDX-License-Identifier: GPL-3.0-or-later
// Upload a mesh, get a session of it, cut it. And what the daemon refuses is said in words.

import { Stage } from './stage';
import { ViewerPage } from './viewer_page';

const CELLS = 24;
const HOT_C = 900;

/** A sheet in the plane z = 0, `width` units wide. */
function sheetObj(width: number): string {
  const at = (i: number): number => width * (i / CELLS - 0.5);
  const lines: string[] = [];
  for (let y = 0; y <= CELLS; y++) for (let x = 0; x <= CELLS; x++) lines.push(`v ${at(x)} ${at(y)} 0`);
  const v = (x: number, y: number): number => y * (CELLS + 1) + x + 1;
  for (let y = 0; y < CELLS; y++)
    for (let x = 0; x < CELLS; x++)
      lines.push(`f ${v(x, y)} ${v(x + 1, y)} ${v(x + 1, y + 1)}`, `f ${v(x, y)} ${v(x + 1, y + 1)} ${v(x, y + 1)}`);
  return lines.join('\n');
}

describe('a mesh of one’s own', () => {
  const stage = new Stage([]);
  let viewer: ViewerPage;

  /** `unit`: millimetres in one unit, '' to let the daemon guess. */
  const give = async (name: string, text: string, unit = ''): Promise<void> => {
    const { page } = viewer;
    await page.locator('#upload input[type=file]').setInputFiles({ name, mimeType: 'text/plain', buffer: Buffer.from(text) });
    await page.locator('#upload input[name=unit]').fill(unit);
    await page.locator('#upload').getByRole('button', { name: 'Upload and create' }).click();
  };

  beforeAll(async () => {
    viewer = await stage.open();
    await viewer.until(() => window.cautery.link === 'online', null, 'online');
    await viewer.page.locator('#upload > summary').click();
  });

  it('says in words what is wrong with a file', async () => {
    await give('broken.obj', 'v 0 0 0\nf 1 2 3\n');
    const problem = viewer.page.locator('#upload .problem');
    await problem.waitFor({ state: 'visible' });
    expect(await problem.textContent()).toMatch(/\w+ \w+/);
    await give('none.stl', '');
    await viewer.page.locator('#upload .problem', { hasText: 'The file is empty.' }).waitFor({ state: 'visible' });
    expect((await viewer.state()).session).toBeNull();
  });

  it('asks for the unit of a mesh that is larger than tissue, and proposes one', async () => {
    await give('large.obj', sheetObj(96));
    const problem = viewer.page.locator('#upload .problem', { hasText: 'did you mean millimetres (one unit is 1 mm)?' });
    await problem.waitFor({ state: 'visible' });
    expect(await problem.textContent()).not.toContain('unit_m');
    expect((await viewer.state()).session).toBeNull();
  });

  it('refuses what needs mending where that is wished', async () => {
    await viewer.page.locator('#upload input[name=strict]').check();
    await give('flat.obj', `${sheetObj(9.6)}\nf 1 2 2\n`);
    await viewer.page.locator('#upload .problem', { hasText: 'degenerate triangles' }).waitFor({ state: 'visible' });
    await viewer.page.locator('#upload input[name=strict]').uncheck();
    expect((await viewer.state()).session).toBeNull();
  });

  it('reads the two files of TetGen as one mesh', async () => {
    const files = { 'tet.ele': '1 4 0\n1 1 2 3 4\n', 'tet.node': '4 3 0 0\n1 0 0 0\n2 5 0 0\n3 0 5 0\n4 0 0 5\n' };
    await viewer.page.locator('#upload input[type=file]').setInputFiles(
      Object.entries(files).map(([name, text]) => ({ name, mimeType: 'text/plain', buffer: Buffer.from(text) })),
    );
    await viewer.page.locator('#upload').getByRole('button', { name: 'Upload and create' }).click();
    await viewer.page.locator('#upload .report', { hasText: 'mesh: 4 vertices, 1 tetrahedra' }).waitFor({ state: 'visible' });
    await viewer.until(() => window.cautery.session?.startsWith('d1-tet') === true, null, 'the session of the tetrahedron');
  });

  it('makes a session of a sound one with the unit guessed and reported, and it can be cut', async () => {
    await give('sheet.obj', sheetObj(9.6));
    await viewer.until(() => window.cautery.session?.startsWith('d1-sheet') === true && window.cautery.tick > 0, null, 'the uploaded tissue is live');
    const report = await viewer.page.locator('#upload .report').textContent();
    expect(report).toContain('one unit is 10 mm (centimetres, guessed)');
    expect(report).toContain(`mesh: ${(CELLS + 1) ** 2} vertices, ${2 * CELLS * CELLS} triangles, 1 component`);
    expect(report).toContain('(tissue fascia)');
    expect(await viewer.faces()).toBe(2 * CELLS * CELLS);
    await viewer.heatTool(HOT_C);
    await viewer.grab([-0.015, 0.002, 0]);
    await viewer.cut(0.002, 0, -0.015, -0.01, 1);
    expect(await viewer.faces()).toBeLessThan(2 * CELLS * CELLS);
    await viewer.screenshot('uploaded-cut');
  });
});
