// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon and the browser for the tests of a `describe`. They start before the first test and end after the last,
// whether it passes or fails.
import type { Browser } from 'playwright-core';

import { Daemon } from './daemon';
import { launch, ViewerPage, type Composing, type PageOptions } from './viewer_page';

/** A browser for the tests of the `describe` that creates it. */
export class BrowserStage {
  browser!: Browser;

  constructor(composing?: Composing) {
    beforeAll(async () => {
      this.browser = await launch(composing);
    });
    afterAll(() => this.browser.close());
  }
}

/** A daemon in addition, and pages of it, all with the options `common`. The beforeAll functions of the `describe`
 * run after both have started. */
export class Stage extends BrowserStage {
  readonly daemon: Daemon;

  constructor(settings: readonly string[], private readonly common: PageOptions = {}, composing?: Composing) {
    super(composing);
    this.daemon = new Daemon(settings);
    beforeAll(() => this.daemon.start());
    afterAll(() => this.daemon.end());
  }

  /** Opens a page for researchers. */
  open(options: PageOptions = {}): Promise<ViewerPage> {
    return ViewerPage.open(this.browser, this.daemon.url, { ...this.common, ...options });
  }

  /** Opens a page in the state of a first visit. */
  openFirst(options: PageOptions = {}): Promise<ViewerPage> {
    return ViewerPage.openFirst(this.browser, this.daemon.url, { ...this.common, ...options });
  }
}

/** Starts a daemon for one test. The daemon ends when the test has passed or failed. */
export async function daemonForTest(settings: readonly string[]): Promise<Daemon> {
  const daemon = new Daemon(settings);
  onTestFinished(() => daemon.end());
  await daemon.start();
  return daemon;
}
