// SPDX-License-Identifier: GPL-3.0-or-later
// The depth of each tool: how far its tip is below the surface to which the hand points. Each tool has its own depth,
// which is 0 when the tool is taken.
import { text } from '../text/text';

const LEAST_M = -0.1; // above the surface
const MOST_M = 0.03; // below it: through every tissue of the scenes

export class Depths {
  private readonly byTool = new Map<string, number>();

  of(tool: string | null): number {
    return (tool === null ? undefined : this.byTool.get(tool)) ?? 0;
  }

  change(tool: string, byM: number): void {
    this.byTool.set(tool, Math.min(Math.max(this.of(tool) + byM, LEAST_M), MOST_M));
  }

  reset(tool: string): void {
    this.byTool.delete(tool);
  }
}

/** For people: "at the surface", "1.5 mm deep", "6.0 mm above". */
export function depthWords(depthM: number): string {
  const millimetres = Math.abs(1000 * depthM).toFixed(1);
  if (millimetres === '0.0') return text.depth.surface;
  return depthM > 0 ? text.depth.deep(millimetres) : text.depth.above(millimetres);
}
