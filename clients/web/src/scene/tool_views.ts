// SPDX-License-Identifier: GPL-3.0-or-later
// The instruments of a session, each drawn where it is and, where tissue keeps it from where its driver wants
// it, once more as a ghost there; of jaws that what they hold keeps open, the jaws alone.
import type { IUniform, Scene, Vector3 } from 'three';

import type { Tool } from '../wire/messages.gen';
import type { ToolState } from '../wire/records';
import { ToolView } from './tool_view';

const GHOST_M = 3e-4; // distance from which a ghost is drawn; nearer it would coincide with the tool

interface ToolPose {
  positionM: readonly number[];
  rotation: readonly number[];
  jaw: number;
}

export class ToolViews {
  readonly solid = new Map<string, ToolView>();
  private readonly ghosts = new Map<string, ToolView>();

  constructor(
    private readonly scene: Scene,
    private readonly light: IUniform<Vector3>,
  ) {}

  /** Sets the definitions of the instruments, when they are added, removed or changed. */
  setTools(tools: readonly Tool[]): void {
    for (const [name, view] of this.solid) {
      const kept = tools.find((tool) => tool.name === name);
      if (!kept || JSON.stringify(kept) !== JSON.stringify(view.definition)) this.remove(name);
    }
    for (const tool of tools) if (!this.solid.has(tool.name)) this.add(tool);
  }

  /** Where one is drawn: the hand's pose goes before the server's, but by as much as tissue keeps the tool from
   * it. Jaws that hold go by the server alone. Says whether the picture is another than before. */
  pose(state: ToolState, hand: ToolPose | undefined, heat: number): boolean {
    const solid = this.solid.get(state.name);
    const ghost = this.ghosts.get(state.name);
    if (!solid || !ghost) return false;
    const asked = hand ?? { ...state.asked, jaw: state.askedJaw };
    const off = state.positionM.map((x, i) => x - state.asked.positionM[i]);
    const at = asked.positionM.map((x, i) => x + off[i]);
    const open = state.jaw - state.askedJaw;
    const askedJaw = state.grasping ? state.askedJaw : asked.jaw;
    const moved = solid.set(at, hand?.rotation ?? state.rotation, askedJaw + open, heat);
    const behind = Math.hypot(...off) > GHOST_M;
    const shown = behind || solid.jawWayM(open) > GHOST_M ? ghost.set(asked.positionM, asked.rotation, askedJaw, 0, !behind) : ghost.hide();
    return moved || shown;
  }

  ghostOf(name: string): boolean {
    return this.ghosts.get(name)?.group.visible ?? false;
  }

  private add(tool: Tool): void {
    for (const views of [this.solid, this.ghosts]) {
      const view = new ToolView(tool, this.light, views === this.ghosts);
      view.group.visible = false;
      views.set(tool.name, view);
      this.scene.add(view.group);
    }
  }

  private remove(name: string): void {
    for (const views of [this.solid, this.ghosts]) {
      const view = views.get(name);
      if (!view) continue;
      this.scene.remove(view.group);
      view.dispose();
      views.delete(name);
    }
  }
}
