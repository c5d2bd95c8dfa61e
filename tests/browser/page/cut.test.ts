// SPDX-License-Identifier: GPL-3.0-or-later
// Joins the demo, drags the hook across the fascia with energy on, and checks that faces go. Then forks the session,
// rewinds it, and finds the tissue whole again.

import { Stage } from './stage';
import { shareChanged, ViewerPage } from './viewer_page';

const FACES = 6000; // number of faces in deploy/scenes/fascia.json
const HOT_C = 900;
/** Least distance of two colours that counts as another colour, of 441. Tissue and drape differ by about 130;
 * drawing, light and antialiasing by less than 15. */
const ANOTHER_COLOUR = 60;
/** The points along the cut. Strands stay across it, and more strands if the hook moved on sooner. */
const WAY = Array.from({ length: 33 }, (_, i): [number, number, number] => [-0.016 + 0.001 * i, 0, 0]);
const SHARE_OPEN = 0.3;

describe('a cut in the demo', () => {
  const stage = new Stage(['--demo', 'fascia']);
  let viewer: ViewerPage;

  beforeAll(async () => {
    viewer = await stage.open();
    await viewer.live('d1-fascia');
  });

  it('parts the fascia where the hook is dragged, in the model and in the picture', async () => {
    expect(await viewer.faces()).toBe(FACES);
    const whole = await viewer.coloursAt(WAY);
    await viewer.heatTool(HOT_C);
    await viewer.grab([-0.02, 0, 0]);
    await viewer.cut(0, 0, -0.02, 0.02, 10);
    const left = await viewer.faces();
    expect(left).toBeLessThan(FACES - 20);
    await viewer.page.keyboard.down('KeyS'); // moves the hook out of the picture's middle
    await viewer.until(() => window.cautery.tip[2] > 0.02, null, 'the hook is lifted');
    await viewer.page.keyboard.up('KeyS');
    await viewer.drawn();
    expect(shareChanged(whole, await viewer.coloursAt(WAY), ANOTHER_COLOUR)).toBeGreaterThan(SHARE_OPEN);
  });

  it('marks the cut in the timeline', async () => {
    await viewer.until(() => document.querySelector('#time .mark.cut') !== null, null, 'a cut is marked');
    const moments = viewer.page.locator('#moments');
    // The cut has two times, because many edges parted one after another.
    const cut = (await moments.locator('option').allTextContents()).find((words) => /^\d+\.\d\d to \d+\.\d\d s: cut, hook$/.test(words));
    expect(cut).toBeDefined();
    await moments.selectOption({ label: cut! });
    await viewer.until((at) => document.querySelector('#rewind')?.textContent === `Rewind to ${at}`, `${cut!.split(' ')[0]} s`, 'the moment of the cut is offered');
    await viewer.page.getByRole('button', { name: 'Return to live' }).click();
    await viewer.until(() => window.cautery.past === null, null, 'the present is shown');
  });

  it('forks: the new session has the cut', async () => {
    const left = await viewer.faces();
    await viewer.page.getByRole('tab', { name: 'Sessions' }).click();
    await viewer.page.getByLabel('Name of the new session').fill('twin');
    await viewer.page.getByRole('button', { name: 'Fork this session' }).click();
    await viewer.live('d1-twin');
    expect(await viewer.faces()).toBe(left);
  });

  it('rewinds the first session: its tissue is whole again', async () => {
    const cut = await viewer.coloursAt(WAY);
    await viewer.page.getByRole('button', { name: 'd1-fascia', exact: true }).click();
    await viewer.live('d1-fascia');
    const { epoch } = await viewer.state();
    await viewer.page.locator('#tick').focus();
    await viewer.page.keyboard.press('Home');
    await viewer.page.locator('#rewind').click();
    await viewer.page.keyboard.press('Escape'); // the page asks first whether to do this
    expect((await viewer.state()).epoch).toBe(epoch);
    await viewer.page.locator('#rewind').click();
    await viewer.page.locator('dialog').getByRole('button', { name: 'Rewind' }).click();
    await viewer.until((before) => window.cautery.epoch !== before, epoch, 'another epoch');
    await viewer.until((count) => Object.values(window.cautery.drawnFaces).reduce((a, b) => a + b, 0) === count, FACES, 'whole again');
    expect((await viewer.state()).energized).toBe(false);
    await viewer.drawn();
    expect(shareChanged(cut, await viewer.coloursAt(WAY), ANOTHER_COLOUR)).toBeGreaterThan(SHARE_OPEN);
  });

  it('leaves the fork cut', async () => {
    await viewer.page.getByRole('button', { name: 'd1-twin', exact: true }).click();
    await viewer.live('d1-twin');
    expect(await viewer.faces()).toBeLessThan(FACES);
  });

  it('never broke the daemon’s headers and never left its host', () => {
    expect(viewer.complaints).toEqual([]);
    expect([...viewer.hosts]).toEqual([`127.0.0.1:${stage.daemon.port}`]);
  });
});
