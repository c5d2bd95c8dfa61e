// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that changes in the panels reach the tissue: forces, pins, limits for each direction, snapshots. A refusal is
// shown where the user made the request.
import type { Locator } from 'playwright-core';

import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

const LIFTED_M = 0.003;
const LIST_READ_AGAIN_MS = 5500; // REFRESH_MS of panels/sessions.ts, and a little more

describe('panels', () => {
  const stage = new Stage(['--demo', 'fascia'], COARSE);
  let viewer: ViewerPage;
  let forces: Locator;

  beforeAll(async () => {
    viewer = await stage.open();
    await viewer.live('d1-fascia');
    forces = viewer.page.locator('#forces');
  });

  it('speaks in millimetres, degrees and sentences', async () => {
    const { page } = viewer;
    expect(await page.locator('#panel-sessions').textContent()).not.toMatch(/avx|sse|neon|scalar/i);
    await page.getByLabel('Name of the new session').fill('My knee');
    await page.getByRole('button', { name: 'Fork this session' }).click();
    const problem = page.locator('#panel-sessions > .problem');
    await problem.waitFor({ state: 'visible' });
    expect(await problem.textContent()).toMatch(/^A name begins with a small letter[^[\]*()]*\.$/);
    await page.waitForTimeout(LIST_READ_AGAIN_MS);
    expect(await problem.isVisible()).toBe(true);
    await page.getByLabel('Name of the new session').fill('');
    await page.getByRole('tab', { name: 'Tools' }).click();
    expect(await page.getByLabel('Hot radius').inputValue()).toBe('3');
    await page.locator('#panel-tools form select[name=shape]').first().selectOption('grasper');
    expect(await page.getByLabel('Jaw open').inputValue()).toBe('34.377');
    await page.locator('#panel-tools form select[name=shape]').first().selectOption('hook');
    expect(await page.getByLabel('Jaw open').isVisible()).toBe(false);
    expect(await page.locator('#panel-tools').getByText('mm/s').count()).toBe(1);
    await page.getByRole('tab', { name: 'Sessions' }).click();
  });

  it('has no form of a generator in a scene with temperatures', async () => {
    const { page } = viewer;
    await page.getByRole('tab', { name: 'Tools' }).click();
    await page.locator('#panel-tools form select[name=shape]').first().waitFor();
    expect.soft(await page.locator('#panel-tools form', { hasText: 'Generator' }).isVisible()).toBe(false);
    await page.getByRole('tab', { name: 'Sessions' }).click();
  });

  it('keeps the state under a name', async () => {
    const { page } = viewer;
    await page.locator('#snapshot > summary').click();
    await page.locator('#snapshot input').fill('flat');
    await page.getByRole('button', { name: 'Take a snapshot' }).click();
    await page.locator('#snapshot [role=status]').getByText(/^flat was saved at \d+\.\d\d s\.$/).waitFor();
  });

  it('applies a force to the vertex nearest to a place', async () => {
    const { page } = viewer;
    await page.getByRole('tab', { name: 'Materials' }).click();
    await forces.locator('summary').click();
    await forces.locator('select[name=selection]').selectOption('nearest');
    await forces.getByLabel('Force on each vertex z').fill('5');
    await forces.getByRole('button', { name: 'Apply the force' }).click();
    await viewer.until((high) => window.cautery.extent().most[2] > high, LIFTED_M, 'the sheet is lifted');
    await forces.getByRole('button', { name: 'No force' }).click();
    await viewer.until((high) => window.cautery.extent().most[2] < high, LIFTED_M, 'the sheet sinks back');
  });

  it('lets a rim go that was pinned', async () => {
    const { least } = await viewer.page.evaluate(() => window.cautery.extent());
    await forces.locator('select[name=selection]').selectOption('rim');
    await forces.getByRole('button', { name: 'Unpin' }).click();
    await forces.locator('.problem').getByText('Choose the layer for the rim').waitFor();
    await forces.locator('select[name=selection-layer]').selectOption('fascia');
    await forces.getByRole('button', { name: 'Unpin' }).click();
    await viewer.until((edge) => window.cautery.extent().least[0] > edge, least[0] + LIFTED_M, 'the taut sheet shrinks');
    await viewer.pause();
  });

  it('goes back to what was kept', async () => {
    const { page } = viewer;
    const { epoch } = await viewer.state();
    await page.getByRole('tab', { name: 'Sessions' }).click();
    await page.locator('#restore').click();
    await page.locator('#snapshot [role=status]').getByText('Restored flat').waitFor();
    await viewer.until((before) => window.cautery.epoch !== before, epoch, 'another epoch');
    await viewer.until(([edge]) => window.cautery.extent().least[0] < edge, [-0.0595], 'the sheet is as wide as it was');
    await page.locator('#snapshot input').fill('never-taken');
    await page.locator('#restore').click();
    await page.locator('#snapshot .problem').waitFor({ state: 'visible' });
    expect(await page.locator('#snapshot .problem').textContent()).toMatch(/\w+ \w+/);
  });

  it('sets limits for each direction of the material', async () => {
    const { page } = viewer;
    await page.getByRole('tab', { name: 'Materials' }).click();
    const form = page.locator('#panel-materials form').first();
    expect(await form.getByLabel('Least strain across').isVisible()).toBe(false);
    await form.getByLabel('Target along fibres').fill('0.5');
    await form.getByRole('button', { name: 'Apply' }).click();
    await viewer.until(() => JSON.stringify(window.cautery.layer('fascia')).includes('"target":[0.5,'), null, 'the daemon has the target');
    expect(await form.getByLabel('Target along fibres').inputValue()).toBe('0.5');
    await form.getByLabel('Target along fibres').fill('-3');
    await form.getByRole('button', { name: 'Apply' }).click();
    await form.locator('.problem').waitFor({ state: 'visible' });
    await form.getByLabel('Strain limit').selectOption('range');
    expect(await form.getByLabel('Least strain across').isVisible()).toBe(true);
    expect(await form.getByLabel('Target along fibres').isVisible()).toBe(false);
  });
});
