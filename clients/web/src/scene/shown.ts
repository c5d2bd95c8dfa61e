// SPDX-License-Identifier: GPL-3.0-or-later
// Whose tissue the screen shows. A picture is there a little after it was asked for.

export class Shown {
  /** null: no tissue yet */
  session: string | null = null;
  private made: string | null = null;
  private asked: string | null = null;

  /** A picture was asked for, with the tissue of a session or with none. */
  ask(session: string | null): void {
    this.asked = session;
  }

  /** What was asked for is made; called once per animation frame. */
  make(): void {
    this.session = this.made;
    this.made = this.asked;
  }

  lose(): void {
    this.session = this.made = this.asked = null;
  }
}
