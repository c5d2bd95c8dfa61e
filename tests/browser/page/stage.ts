// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of a `describe` play on: a daemon and a browser, there before the first of them and gone
// after the last, passed or failed.
import type { Browser } from 'playwright-core';

import { Daemon } from './daemon';
import { launch, ViewerPage, type Composing, type PageOptions } from './viewer_page';

/** A browser for the tests of the `describe` in which it is made. */
export class BrowserStage {
  browser!: Browser;

  constructor(composing?: Composing) {
    beforeAll(async () => {
      this.browser = await launch(composing);
    });
    afterAll(() => this.browser.close());
  }
}

/** A daemon besides, and pages of it, all with the options `common`. Whatever the `describe` does before all of its tests comes after both have started. */
export class Stage extends BrowserStage {
  readonly daemon: Daemon;

  constructor(settings: readonly string[], private readonly common: PageOptions = {}, composing?: Composing) {
    super(composing);
    this.daemon = new Daemon(settings);
    beforeAll(() => this.daemon.start());
    afterAll(() => this.daemon.end());
  }

  /** A page for researchers. */
  open(options: PageOptions = {}): Promise<ViewerPage> {
    return ViewerPage.open(this.browser, this.daemon.url, { ...this.common, ...options });
  }

  /** A page as it comes up the first time. */
  openFirst(options: PageOptions = {}): Promise<ViewerPage> {
    return ViewerPage.openFirst(this.browser, this.daemon.url, { ...this.common, ...options });
  }
}

/** A daemon for one test, started; gone when the test has passed or failed. */
export async function daemonForTest(settings: readonly string[]): Promise<Daemon> {
  const daemon = new Daemon(settings);
  onTestFinished(() => daemon.end());
  await daemon.start();
  return daemon;
}
