// SPDX-License-Identifier: GPL-3.0-or-later
// Makes pictures of a scripted cut: before, during and after, from far to close, along the cut and across it; those after
// the cut in both themes. Only `run_viewer_tests.sh wound` makes them, for clients/web/pictures/wound, where people look
// at them.
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { record, type Command } from './recording';
import { Stage } from './stage';
import { ViewerPage } from './viewer_page';

const FOLDER = process.env['CAUTERY_WOUND'];
const SESSION = 'd1-layers';
const TOOL = { session: SESSION, tool: 'hook' };
const WINDOW = { width: 900, height: 540 };
const JPEG_QUALITY = 82;
/** A hook of 1.5 mm wire, which needs a grid of the same fineness. */
const HOOK = { ...TOOL, shape: 'hook', temperature_c: 190, hot_radius_m: 0.00075, tip_length_m: 0.007, grid_step_m: 0.00075, grid_cells: 20 };
const TILTED = [0.9763, 0.21644, 0, 0];
const TICKS_PER_S = 60;
const STAY_S = 4;
const SPEED_M_S = 0.0016; // speed at which the hook is over each place twice as long as the toughest bundles there need
type Point = readonly [number, number, number];
const START: Point = [-0.022, 0, 0.0015];
const END: Point = [0.014, 0, 0.0015];
const AWAY: Point = [0.045, 0.02, 0.05];

/** Azimuth and elevation in degrees, distance and target in millimetres, as in the page's address. */
const CAMERAS: Record<string, string> = {
  'far': '-90,49,190,0,0,0',
  'middle': '-90,55,75,-6,0,2',
  'close': '-90,50,26,-12,0,1',
  'far-across': '0,45,190,0,0,0',
  'middle-across': '-10,45,75,-6,0,2',
  'close-across': '-10,40,26,-12,0,1',
  'far-low': '-60,22,190,0,0,0',
  'close-low': '-60,24,26,-12,0,1',
};

let sequence = 0;

/** Moves the tool from one place to another in `ticks` ticks, after it has stayed at the first for `stayTicks`. */
function lead(from: Point, to: Point, stayTicks: number, ticks: number, energized: boolean): Command {
  return (step, call) => {
    if (step === 0) {
      call('tool.take_over', TOOL);
      call('tool.configure', HOOK);
    }
    const share = Math.min(Math.max((step - stayTicks) / ticks, 0), 1);
    const position = from.map((x, i) => x + (to[i] - x) * share);
    call('tool.move', { ...TOOL, sequence: ++sequence, position_m: position, rotation: TILTED, jaw: 0 });
    call('tool.energize', { ...TOOL, sequence: ++sequence, energized });
  };
}

describe.runIf(FOLDER)('a scripted cut', () => {
  const stage = new Stage(['--demo', 'layers']);

  const play = (from: Point, to: Point, staysS: number, speedMS: number, energized: boolean): Promise<unknown> => {
    const stay = Math.round(staysS * TICKS_PER_S);
    const ticks = Math.max(1, Math.round((TICKS_PER_S * Math.hypot(...from.map((x, i) => to[i] - x))) / speedMS));
    return record(stage.daemon.url, SESSION, stay + ticks + 1, lead(from, to, stay, ticks, energized));
  };

  const look = async (when: string, colorScheme: 'dark' | 'light' = 'dark'): Promise<void> => {
    for (const [name, camera] of Object.entries(CAMERAS)) {
      if (colorScheme === 'light' && name.endsWith('low')) continue;
      const viewer = await ViewerPage.openFirst(stage.browser, `${stage.daemon.url}?session=${SESSION}&camera=${camera}`, { viewport: WINDOW, colorScheme });
      await viewer.live(SESSION);
      await viewer.page.evaluate(() => document.querySelectorAll<HTMLElement>('#cue, #handles').forEach((one) => (one.style.visibility = 'hidden')));
      await viewer.until(() => window.cautery.idle, null, 'the sharp picture');
      const clip = (await viewer.page.locator('#picture').boundingBox())!;
      const picture = await viewer.page.screenshot({ clip, type: 'jpeg', quality: JPEG_QUALITY });
      mkdirSync(FOLDER!, { recursive: true });
      writeFileSync(join(FOLDER!, `${when}-${name}.jpg`), picture);
      expect(viewer.complaints).toEqual([]);
      await viewer.close();
    }
  };

  it('is looked at', async () => {
    const over: Point = [START[0], START[1], 0.03];
    const middle = START.map((x, i) => (x + END[i]) / 2) as unknown as Point;
    await play(over, over, 0, 1, false);
    await look('before');
    await play(over, START, 0, 0.05, false);
    await play(START, middle, STAY_S, SPEED_M_S, true);
    await look('during');
    await play(middle, END, 0, SPEED_M_S, true);
    await play(END, AWAY, 0, 0.1, false);
    await play(AWAY, AWAY, 2, 1, false); // the cut tissue comes to rest
    await look('after');
    await look('after-light', 'light');
  }, 1_800_000);
});
