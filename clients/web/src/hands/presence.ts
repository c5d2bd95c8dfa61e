// SPDX-License-Identifier: GPL-3.0-or-later
// The page's signs of life: often while something is held, now and then otherwise, none while the page is
// out of sight or without the focus. They come from the page's own thread: one that hangs must lose its
// energy.
import type { Link } from '../wire/link';

const HELD_MS = 50; // a fifth of the daemon's shortest patience
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
