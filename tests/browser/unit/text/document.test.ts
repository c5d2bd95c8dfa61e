// SPDX-License-Identifier: GPL-3.0-or-later
import { labelPage } from '../../../../clients/web/src/text/document';
import { en } from '../../../../clients/web/src/text/en';

describe('the page', () => {
  afterEach(() => vi.unstubAllGlobals());

  it('has its language and the names of its elements at once', () => {
    const names: Record<string, string> = {};
    const documentElement = { lang: '' };
    const getElementById = (id: string): object => ({ setAttribute: (attribute: string, name: string) => (names[`${id} ${attribute}`] = name) });
    vi.stubGlobal('document', { documentElement, getElementById });
    labelPage();
    expect(documentElement.lang).toBe('en');
    expect(names['tissue aria-label']).toBe('Tissue');
    expect(Object.values(names)).toEqual(Object.values(en.page.labels));
  });
});
