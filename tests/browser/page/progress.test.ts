// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a long operation shows its name, with a moving bar, over any picture, and that tissue is shown when it
// ends. A door holds the daemon's answers back while the test looks.
import { HoldingDoor } from './door';
import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

describe('while something is under way', () => {
  const stage = new Stage(['--demo', 'fascia']);
  let door: HoldingDoor;
  let viewer: ViewerPage;

  beforeAll(async () => {
    door = new HoldingDoor(stage.daemon.url);
    viewer = await ViewerPage.open(stage.browser, await door.start(), COARSE);
    await viewer.live('d1-fascia');
  });
  afterEach(() => door.letGo());
  afterAll(() => door.end());

  const told = async (words: RegExp): Promise<void> => {
    await viewer.page.locator('#veil p').getByText(words).waitFor();
    expect(await viewer.page.locator('#veil progress').isVisible()).toBe(true);
  };
  /** Waits until the veil has gone and tissue of a visible size is in the picture. */
  const seen = async (): Promise<void> => {
    await viewer.until(() => document.querySelector<HTMLElement>('#veil')!.hidden === true, null, 'the picture is live again');
    const { least, most } = await viewer.page.evaluate(() => window.cautery.extent());
    expect(most[0] - least[0]).toBeGreaterThan(0.05);
  };

  it('making a session is said, and opening it, until its tissue is there', async () => {
    const { page } = viewer;
    door.hold('session.create');
    await page.getByText('New session', { exact: true }).click();
    await page.getByLabel('Scene').selectOption('fascia');
    await page.getByRole('textbox', { name: 'Name', exact: true }).fill('second');
    await page.getByRole('button', { name: 'Create', exact: true }).click();
    await told(/^Creating the session…$/);
    door.letGo();
    door.hold('frames');
    await told(/^(Opening d1-second…|d1-second is being made: .*)$/);
    door.letGo();
    await viewer.live('d1-second');
    await seen();
  });

  it('a session that somebody else is making says so', async () => {
    const { page } = viewer;
    // The daemon makes the session in a moment. Its answers are changed on their way, as if it were still busy.
    door.change = (text) => text.replace(/("session": ?"d1-second"[^{}]*?"state": ?)"(running|paused)"/g, '$1"starting"');
    await viewer.until(() => window.location.search.includes('session=d1-second'), null, 'the address');
    await page.reload(); // the page returns to d1-second
    await told(/^d1-second is being built…$/);
    door.change = null;
    await page.reload();
    await viewer.live('d1-second');
    await seen();
  });

  it('copying one is said, until the copy is there', async () => {
    const { page } = viewer;
    const faces = await viewer.faces();
    door.hold('session.fork');
    await page.getByLabel('Name of the new session').fill('twin');
    await page.getByRole('button', { name: 'Fork this session' }).click();
    await told(/^Copying the session…$/);
    expect((await viewer.state()).session).toBe('d1-second'); // the session under the veil is the same as before
    expect(await viewer.faces()).toBe(faces);
    door.letGo();
    await viewer.live('d1-twin');
    await seen();
  });

  it('a rewind is announced, with its tick', async () => {
    const { page } = viewer;
    await page.getByRole('button', { name: 'd1-fascia', exact: true }).click();
    await viewer.live('d1-fascia');
    const { epoch } = await viewer.state();
    door.hold('session.rewind');
    await page.locator('#tick').focus();
    await page.keyboard.press('Home');
    const to = ((await page.locator('#rewind').textContent()) ?? '').replace('Rewind to ', '');
    await page.locator('#rewind').click();
    await page.locator('dialog').getByRole('button', { name: 'Rewind' }).click();
    await told(new RegExp(`^Rewinding to ${to.replace('.', '\\.')}…$`));
    door.letGo();
    await viewer.until((before) => window.cautery.epoch !== before, epoch, 'another epoch');
    await seen();
  });

  it('starting over is said', async () => {
    const { page } = viewer;
    door.hold('session.reset');
    await page.getByRole('button', { name: 'Start over' }).click();
    await page.locator('dialog').getByRole('button', { name: 'Start over' }).click();
    await told(/^Resetting…$/);
    door.letGo();
    await seen();
    expect(viewer.complaints).toEqual([]);
  });
});
