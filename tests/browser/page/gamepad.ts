// SPDX-License-Identifier: GPL-3.0-or-later
// A gamepad with the standard mapping that tests control.
import type { ViewerPage } from './viewer_page';

export const RIGHT_TRIGGER = 7;
export const A = 0;

interface TestPad {
  axes: number[];
  buttons: { pressed: boolean; value: number }[];
}

/** In the page: installs the only gamepad. */
export function holdGamepad(): void {
  const pad = {
    id: 'test', index: 0, connected: true, mapping: 'standard', timestamp: 0,
    axes: [0, 0, 0, 0], buttons: Array.from({ length: 17 }, () => ({ pressed: false, touched: false, value: 0 })),
  };
  Object.assign(window, { testPad: pad });
  navigator.getGamepads = () => [pad as unknown as Gamepad];
}

export async function setPad(viewer: ViewerPage, axes: number[], held: readonly number[]): Promise<void> {
  await viewer.page.evaluate(
    ([stick, pressed]) => {
      const pad = (window as unknown as { testPad: TestPad }).testPad;
      pad.axes = stick;
      pad.buttons.forEach((button, i) => Object.assign(button, { pressed: pressed.includes(i), value: pressed.includes(i) ? 1 : 0 }));
    },
    [axes, [...held]] as const,
  );
}
