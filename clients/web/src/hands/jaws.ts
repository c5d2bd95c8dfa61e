// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws: a command closes or opens them, or they are closed while something is held, once the tool has reached its
// commanded position.
import { Vector3 } from 'three';

import type { Control } from '../model/control';
import type { Model } from '../model/model';
import { hasJaws } from '../model/tool_parts';
import { errorWords } from '../model/sentences';

const ARRIVED_M = 0.001;

export class Jaws {
  /** whether a hold closes the jaws: no, when the tool has arrived, or yes */
  private pressed: 'no' | 'soon' | 'yes' = 'no';

  constructor(
    private readonly model: Model,
    private readonly control: Control,
    private readonly sequence: () => number,
  ) {}

  get usable(): boolean {
    return this.model.driving && this.model.tool !== null && hasJaws(this.model.tool.shape);
  }

  grasp(closed: boolean): void {
    const { model } = this;
    if (!this.usable || model.selectedTool === null) return;
    const method = closed ? 'tool.grasp' : 'tool.release';
    this.control
      .call(method, { tool: model.selectedTool, sequence: this.sequence() })
      .catch((error: unknown) => model.say('error', errorWords(error)));
  }

  press(): void {
    if (this.usable && this.model.toolState?.grasping === false && this.pressed === 'no') this.pressed = 'soon';
  }

  letGo(): void {
    if (this.pressed === 'yes') this.grasp(false);
    this.pressed = 'no';
  }

  /** Notes that the tool has arrived; waiting jaws close. */
  arrived(position: Vector3): void {
    const state = this.model.toolState;
    if (this.pressed !== 'soon' || !state || position.distanceTo(new Vector3(...state.asked.positionM)) > ARRIVED_M) return;
    this.pressed = 'yes';
    this.grasp(true);
  }
}
