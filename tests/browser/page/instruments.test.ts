// SPDX-License-Identifier: GPL-3.0-or-later
// With energy `tissue`, the selected tool becomes another instrument, in a mode and with a power that its generator
// has. Without this kind of energy there is no generator to set: panels.test.ts.
import AxeBuilder from '@axe-core/playwright';
import type { Locator } from 'playwright-core';

import { Stage } from './stage';
import { COARSE, type ViewerPage } from './viewer_page';

describe('the form of the generator', () => {
  const stage = new Stage(['--demo', 'fascia-power'], COARSE);
  let viewer: ViewerPage;
  let form: Locator;

  beforeAll(async () => {
    viewer = await stage.open();
    await viewer.live('d1-fascia-power');
    await viewer.page.getByRole('tab', { name: 'Tools' }).click();
    form = viewer.page.locator('#panel-tools form', { hasText: 'Generator' });
  });

  const choose = (name: string, value: string): Promise<unknown> => form.locator(`select[name=${name}]`).selectOption(value);
  const power = (): Locator => form.getByLabel('Power');

  it('offers the instruments, and the modes and powers of the one that is chosen', async () => {
    await form.waitFor();
    expect(await form.locator('select[name=profile] option').count()).toBe(6);
    expect(await form.getByRole('button', { name: 'Set' }).isDisabled()).toBe(true); // the tool has no driver
    await choose('profile', 'ultrasonic-shears');
    expect(await form.locator('select[name=mode] option').allTextContents()).toEqual(['level 1', 'level 2', 'level 3', 'level 4', 'level 5']);
    await choose('profile', 'monopolar-spatula');
    await choose('mode', 'coagulation');
    expect([await power().inputValue(), await power().getAttribute('max')]).toEqual(['55', '75']);
    const { violations } = await new AxeBuilder({ page: viewer.page }).include('#panel-tools').analyze();
    expect(violations.map(({ id }) => id)).toEqual([]);
  });

  it('makes the tool in hand that instrument', async () => {
    await viewer.page.locator('#panel-tools .take').click();
    await viewer.page.locator('#panel-tools .give').waitFor();
    await power().fill('40');
    await form.getByRole('button', { name: 'Set' }).click();
    await viewer.until(() => document.querySelector<HTMLSelectElement>('#panel-tools select[name=shape]')?.value === 'spatula', null, 'the shape');
    expect([await form.locator('select[name=profile]').inputValue(), await form.locator('select[name=mode]').inputValue(), await power().inputValue()]).toEqual(['monopolar-spatula', 'coagulation', '40']);
    await viewer.screenshot('instruments');
    expect(viewer.complaints).toEqual([]);
  });
});
