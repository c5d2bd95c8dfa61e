// SPDX-License-Identifier: GPL-3.0-or-later
// Sends motions of the tool in hand to the daemon: always the newest, and not more often than the daemon uses.
import type { Quaternion, Vector3 } from 'three';

import type { Control } from '../model/control';

const SEND_MS = 1000 / 120;

export interface Wanted {
  position: Vector3;
  rotation: Quaternion;
  jaw: number;
}

export class Motion {
  private sentAt = -Infinity;
  /** whether there is a motion that was not sent yet */
  unsent = false;

  constructor(
    private readonly control: Control,
    private readonly sequence: () => number,
  ) {}

  send(now: number, tool: string, { position, rotation, jaw }: Wanted): void {
    if (!this.unsent || now - this.sentAt < SEND_MS) return;
    this.unsent = false;
    this.sentAt = now;
    this.control.link.notify('tool.move', {
      ...this.control.here(),
      tool,
      sequence: this.sequence(),
      position_m: position.toArray(),
      rotation: [rotation.w, rotation.x, rotation.y, rotation.z],
      jaw,
    });
  }
}
