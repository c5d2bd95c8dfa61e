// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the upload of a mesh, a session with it, and a cut. A refusal of the daemon is shown in words.

import { Door } from './door';
import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

const CELLS = 24;
const HOT_C = 900;

/** Returns a sheet in the plane z = 0, `width` units wide. */
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

const BALL = 16; // rows of triangles of a ball

/** Returns a closed ball around `middle`, in units. */
function ballObj(radius: number, middle: number): string {
  const around = 2 * BALL;
  const lines = [`v 0 0 ${middle + radius}`, `v 0 0 ${middle - radius}`];
  for (let row = 1; row < BALL; row++)
    for (let k = 0; k < around; k++) {
      const [down, turn] = [(Math.PI * row) / BALL, (2 * Math.PI * k) / around];
      lines.push(`v ${radius * Math.sin(down) * Math.cos(turn)} ${radius * Math.sin(down) * Math.sin(turn)} ${middle + radius * Math.cos(down)}`);
    }
  const v = (row: number, k: number): number => (row === 0 ? 1 : row === BALL ? 2 : 3 + (row - 1) * around + (k % around));
  for (let row = 0; row < BALL; row++)
    for (let k = 0; k < around; k++) {
      if (row > 0) lines.push(`f ${v(row, k)} ${v(row + 1, k)} ${v(row, k + 1)}`);
      if (row < BALL - 1) lines.push(`f ${v(row + 1, k)} ${v(row + 1, k + 1)} ${v(row, k + 1)}`);
    }
  return lines.join('\n');
}

describe('a mesh of one’s own', () => {
  const stage = new Stage([], COARSE);
  let viewer: ViewerPage;

  /** Gives the page a file. `unit`: millimetres in one unit; '': the daemon guesses the unit. */
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
    await give('large.obj', sheetObj(40));
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

describe('a body of one’s own', () => {
  const stage = new Stage([], COARSE);
  let viewer: ViewerPage;
  let door: Door;
  const errors: string[] = [];

  const drop = async (name: string, text: string): Promise<void> => {
    await viewer.page.evaluate(
      ({ name: fileName, text: content }) => {
        const data = new DataTransfer();
        data.items.add(new File([content], fileName));
        document.body.dispatchEvent(new DragEvent('dragover', { dataTransfer: data, bubbles: true, cancelable: true }));
        document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
      },
      { name, text },
    );
  };

  beforeAll(async () => {
    door = new Door(stage.daemon.url);
    door.change = (text) => {
      if (/"error":/.test(text)) errors.push(text);
      return text;
    };
    viewer = await ViewerPage.open(stage.browser, await door.start(), COARSE, 'operate');
    await viewer.until(() => window.cautery.link === 'online', null, 'online');
  });

  afterAll(async () => {
    await viewer.close();
    await door.end();
  });

  it('is filled with tetrahedra where it is dropped on the page, whatever the page shows', async () => {
    await drop('ball.obj', ballObj(30, 0));
    await viewer.until(() => window.cautery.session?.startsWith('d1-ball') === true && window.cautery.tick > 0, null, 'the body is live');
    const report = viewer.page.locator('#upload .report');
    await report.waitFor({ state: 'visible' });
    const words = await report.textContent();
    expect(words).toContain('one unit is 1 mm (millimetres, guessed)');
    expect(words).toMatch(/mesh: \d+ vertices, \d+ tetrahedra, 1 component/);
    expect(words).toContain('filled with tetrahedra (tissue fat)');
  });

  it('is pinned where it is pointed at', async () => {
    const { page } = viewer;
    const before = door.asked.length;
    await viewer.drawn();
    await page.getByRole('button', { name: 'Pin', exact: true }).first().click();
    const top = await viewer.project([0, 0, 0.03]);
    await page.mouse.move(top.x, top.y);
    await page.mouse.down();
    await page.mouse.up();
    await expect.poll(() => door.asked.slice(before).includes('pin')).toBe(true);
    expect(errors).toEqual([]);
  });

  it('is not made where the user cancels', async () => {
    const { page } = viewer;
    await page.locator('#upload input[name=edge]').fill('0.4');
    await drop('fine.obj', ballObj(30, 0));
    await page.locator('#upload').getByRole('button', { name: 'Cancel' }).click();
    await page.locator('#upload .problem', { hasText: 'Cancelled' }).waitFor({ state: 'visible' });
    expect((await viewer.state()).session).toMatch(/^d1-ball/);
  });
});
