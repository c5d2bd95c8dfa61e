// SPDX-License-Identifier: GPL-3.0-or-later
// Heartbeats of the page: often while something is held, rarely otherwise, none while the page is hidden or without the
// focus. The main thread of the page sends them, because a page that hangs must lose its energy.
import type { Link } from '../wire/link';

const HELD_MS = 50; // a fifth of the daemon's shortest deadline
const IDLE_MS = 1000;

export class Presence {
  private last = 0;

  constructor(
    private readonly link: Link,
    private readonly holding: () => boolean,
  ) {
    setInterval(() => this.beat(), HELD_MS);
    document.addEventListener('visibilitychange', () => document.hidden && this.hide());
    window.addEventListener('blur', () => this.hide());
    window.addEventListener('focus', () => this.link.heartbeat(true));
  }

  private beat(): void {
    if (document.hidden || !document.hasFocus()) return;
    const now = performance.now();
    if (!this.holding() && now - this.last < IDLE_MS) return;
    this.last = now;
    this.link.heartbeat(true);
  }

  private hide(): void {
    this.link.heartbeat(false);
  }
}
