// SPDX-License-Identifier: GPL-3.0-or-later
// The session whose tissue the screen shows. A picture appears on it some frames after its drawing commands.

export class Shown {
  /** null: no tissue yet */
  session: string | null = null;
  private finished: string | null = null;
  private drawn: string | null = null;

  /** Drawing commands of a picture were given, with the tissue of a session or without. */
  draw(session: string | null): void {
    this.drawn = session;
  }

  /** The graphics card has finished the last picture. The screen shows it from the next call on; one per animation frame. */
  finish(): void {
    this.session = this.finished;
    this.finished = this.drawn;
  }

  lose(): void {
    this.session = this.finished = this.drawn = null;
  }
}
