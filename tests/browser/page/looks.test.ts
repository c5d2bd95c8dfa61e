// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the cost of a picture of the demo by counting draw calls, triangles and bytes of textures. With the body around
// the tissue, each may be at most twice that of the tissue alone on its cloth. Also tests what a user must see in the
// picture.
import { Stage } from './stage';
import type { Colour, ViewerPage } from './viewer_page';

/** Counts for the tissue alone on its cloth, in the home view of `layers`. */
const ALONE = { calls: 10, triangles: 20_389, textureBytes: 48 ** 3 + 2 * 4 * 256 };

interface Counts {
  calls: number;
  triangles: number;
  textureBytes: number;
}

/** In the page, before its scripts: counts the calls of WebGL. */
function countDrawing(): void {
  const counts: Counts = { calls: 0, triangles: 0, textureBytes: 0 };
  Object.assign(window, { counts });
  const gl = WebGL2RenderingContext.prototype;
  const texel = (format: number): number => (format === WebGL2RenderingContext.R8 ? 1 : 4);
  const around = <K extends 'clear' | 'drawElements' | 'drawArrays' | 'texStorage2D' | 'texStorage3D'>(name: K, tell: (given: number[]) => void): void => {
    const real = gl[name];
    (gl as unknown as Record<string, unknown>)[name] = function (this: WebGL2RenderingContext, ...given: number[]) {
      tell(given);
      Reflect.apply(real, this, given);
    };
  };
  const drawn = (mode: number, vertices: number): void => {
    counts.calls++;
    if (mode === WebGL2RenderingContext.TRIANGLES) counts.triangles += vertices / 3;
  };
  const stored = (levels: number, format: number, width: number, height: number, depth: number, shrinks: number): void => {
    for (let level = 0; level < levels; level++) counts.textureBytes += (texel(format) * width * height * depth) / shrinks ** level;
  };
  around('clear', () => Object.assign(counts, { calls: 0, triangles: 0 })); // clear() begins a picture
  around('drawElements', ([mode, vertices]) => drawn(mode, vertices));
  around('drawArrays', ([mode, , vertices]) => drawn(mode, vertices));
  around('texStorage2D', ([, levels, format, width, height]) => stored(levels, format, width, height, 1, 4));
  around('texStorage3D', ([, levels, format, width, height, depth]) => stored(levels, format, width, height, depth, 8));
}

type Point = [number, number, number];
const SURFACE_Z_M = 0.002; // height of the fascia in deploy/scenes/layers.json
/** Share of nearly white pixels of the tissue in the home view: enough to look wet, and not so much that the tissue
 * is covered. */
const WET_LEAST = 0.004;
const WET_MOST = 0.12;
const SPARKS_MOST = 2e-4; // largest share of sparkling pixels; a hundred in a picture would be visible when the camera moves
const BESIDE_M = 0.001; // distance of the compared places from a ring, whose width is a fifth of this
const HIGHER_M = 0.003;
const TAP_MS = 50;
const TAPS_MOST = 400;
// least difference of brightness, of 255: a ring moves the colour under it more than half of the way to white
const BRIGHTER = 12;

const light = (colours: readonly Colour[]): number => colours.reduce((sum, [r, g, b]) => sum + (r + g + b) / 3, 0) / colours.length;

/** Returns how much brighter the tissue is on the ring under the tip than on both sides of it, and the ring's
 * radius. */
async function ring(viewer: ViewerPage): Promise<{ brighter: number; radius: number }> {
  const { tip: [x, y, z], tool } = await viewer.state();
  const hot = tool?.hot_radius_m ?? 0.003;
  const radius = hot + 0.5 * (z - hot - SURFACE_Z_M);
  // angles in front of the tool, where it hides nothing
  const angles = Array.from({ length: 15 }, (_, i) => -Math.PI / 2 + 0.08 * (i - 7));
  const circle = (r: number): Point[] => angles.map((angle) => [x + r * Math.cos(angle), y + r * Math.sin(angle), SURFACE_Z_M]);
  const colours = await viewer.coloursAt([radius, radius - BESIDE_M, radius + BESIDE_M].flatMap(circle), 1);
  const part = (i: number): number => light(colours.slice(i * angles.length, (i + 1) * angles.length));
  return { brighter: part(0) - (part(1) + part(2)) / 2, radius };
}

describe('the picture of the demo', () => {
  const stage = new Stage(['--demo', 'layers']);


  it('costs at most twice what the tissue alone on its cloth did', async () => {
    const viewer = await stage.openFirst({ before: countDrawing });
    await viewer.live('d1-layers');
    await viewer.pause();
    await viewer.until(() => window.cautery.idle, null, 'the sharp picture');
    const counts = await viewer.page.evaluate(() => (window as unknown as { counts: Counts }).counts);
    process.stdout.write(`a picture: ${counts.calls} draw calls, ${Math.round(counts.triangles)} triangles, ${Math.round(counts.textureBytes / 1000)} KB of textures\n`);
    for (const what of ['calls', 'triangles', 'textureBytes'] as const) {
      expect(counts[what], what).toBeGreaterThan(0);
      expect(counts[what], what).toBeLessThanOrEqual(2 * ALONE[what]);
    }
    expect(viewer.complaints).toEqual([]);
    await viewer.resume();
    await viewer.close();
  });

  it('shows by a ring under the tip how high the tip is', async () => {
    const viewer = await stage.openFirst();
    await viewer.live('d1-layers');
    await viewer.page.getByRole('button', { name: 'Take the tool' }).click();
    await viewer.until(() => window.cautery.driving, null, 'the tool is taken');
    const { x, y } = await viewer.project([0.015, 0.004, SURFACE_Z_M]);
    await viewer.page.mouse.move(x, y);
    await viewer.page.mouse.move(x + 1, y);
    await viewer.until(() => Math.abs(window.cautery.tip[0] - 0.015) < 0.003, null, 'the tool hovers there');
    await viewer.pause();
    await viewer.until(() => window.cautery.idle, null, 'the picture of it');
    const low = await ring(viewer);
    await viewer.resume();
    await viewer.page.locator('#picture').focus();
    const { tip } = await viewer.state();
    // The tool is lifted by taps. On a busy machine a held key is released late, and the tool would be far above the
    // tissue.
    for (let taps = 0; (await viewer.state()).tip[2] < tip[2] + HIGHER_M && taps < TAPS_MOST; taps++) await viewer.page.keyboard.press('KeyS', { delay: TAP_MS });
    expect((await viewer.state()).tip[2]).toBeGreaterThan(tip[2] + HIGHER_M);
    await viewer.pause();
    await viewer.until(() => window.cautery.idle, null, 'the picture of that');
    const high = await ring(viewer);
    await viewer.screenshot('ring');
    await viewer.resume();
    process.stdout.write(`rings: ${[low, high].map(({ radius, brighter }) => `radius ${(1000 * radius).toFixed(1)} mm, ${brighter.toFixed(0)} brighter`).join('; ')}\n`);
    expect(high.radius).toBeGreaterThan(low.radius);
    expect(low.brighter).toBeGreaterThan(BRIGHTER);
    expect(high.brighter).toBeGreaterThan(BRIGHTER);
    await viewer.close();
  });

  it('shines wet where it lies at home, and does not sparkle', async () => {
    const viewer = await stage.openFirst();
    await viewer.live('d1-layers');
    await viewer.pause();
    await viewer.until(() => window.cautery.idle, null, 'the sharp picture');
    const { wet, sparks } = await viewer.shine([-0.05, -0.03, SURFACE_Z_M], [0.05, 0.035, SURFACE_Z_M]);
    process.stdout.write(`home: ${(100 * wet).toFixed(2)} % of the tissue mirrors the lamp, ${(1e6 * sparks).toFixed(0)} sparks in a million\n`);
    expect(wet).toBeGreaterThan(WET_LEAST);
    expect(wet).toBeLessThan(WET_MOST);
    expect(sparks).toBeLessThan(SPARKS_MOST);
    await viewer.resume();
    await viewer.close();
  });
});
