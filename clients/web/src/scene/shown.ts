// SPDX-License-Identifier: GPL-3.0-or-later
// The session whose tissue the screen shows. A picture appears on it some frames after its drawing commands.

export class Shown {
  /** session whose tissue the screen shows; null: no tissue yet */
  session: string | null = null;
  private finished: string | null = null;
  private drawn: string | null = null;

  /** Notes that the drawing commands of a picture were given, with or without the tissue of a session. */
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
