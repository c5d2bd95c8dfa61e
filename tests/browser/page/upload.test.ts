// SPDX-License-Identifier: GPL-3.0-or-later
// Upload a mesh, get a session of it, cut it. And what the daemon refuses is said in words.

import { Stage } from './stage';
import { ViewerPage } from './viewer_page';

const CELLS = 24;
const HOT_C = 900;

/** A sheet in the plane z = 0, 96 units wide. */
function sheetObj(): string {
  const at = (i: number): number => 4 * (i - CELLS / 2);
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

  const give = async (name: string, text: string): Promise<void> => {
    const { page } = viewer;
    await page.locator('#upload input[type=file]').setInputFiles({ name, mimeType: 'text/plain', buffer: Buffer.from(text) });
    await page.locator('#upload input[name=unit]').fill('1');
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
    expect((await viewer.state()).session).toBeNull();
  });

  it('makes a session of a sound one, which can be cut', async () => {
    await give('sheet.obj', sheetObj());
    await viewer.until(() => window.cautery.tick > 0, null, 'the uploaded tissue is live');
    expect(await viewer.faces()).toBe(2 * CELLS * CELLS);
    await viewer.heatTool(HOT_C);
    await viewer.grab([-0.015, 0.002, 0]);
    await viewer.cut(0.002, 0, -0.015, -0.01, 1);
    expect(await viewer.faces()).toBeLessThan(2 * CELLS * CELLS);
    await viewer.screenshot('uploaded-cut');
  });
});
