// SPDX-License-Identifier: GPL-3.0-or-later
// What a picture of the demo costs, by counting: draw calls, triangles, bytes of textures. A body around the
// tissue may make each twice what the tissue alone on its cloth was.

import { Stage } from './stage';

/** Of the tissue on its cloth alone, in the home view of `layers`. */
const ALONE = { calls: 10, triangles: 20_389, textureBytes: 48 ** 3 + 2 * 4 * 256 };

interface Counts {
  calls: number;
  triangles: number;
  textureBytes: number;
}

/** In the page, before its scripts: counts what WebGL is told. */
function countDrawing(): void {
  const counts: Counts = { calls: 0, triangles: 0, textureBytes: 0 };
  Object.assign(window, { counts });
  const gl = WebGL2RenderingContext.prototype;
  const texel = (format: number): number => (format === WebGL2RenderingContext.R8 ? 1 : 4);
  const around = <K extends 'clear' | 'drawElements' | 'drawArrays' | 'texStorage2D' | 'texStorage3D'>(name: K, tell: (given: number[]) => void): void => {
    const real = gl[name] as (this: WebGL2RenderingContext, ...given: number[]) => void;
    (gl as unknown as Record<string, unknown>)[name] = function (this: WebGL2RenderingContext, ...given: number[]) {
      tell(given);
      real.apply(this, given);
    };
  };
  const drawn = (mode: number, vertices: number): void => {
    counts.calls++;
    if (mode === WebGL2RenderingContext.TRIANGLES) counts.triangles += vertices / 3;
  };
  const stored = (levels: number, format: number, width: number, height: number, depth: number, shrinks: number): void => {
    for (let level = 0; level < levels; level++) counts.textureBytes += (texel(format) * width * height * depth) / shrinks ** level;
  };
  around('clear', () => Object.assign(counts, { calls: 0, triangles: 0 })); // a picture begins
  around('drawElements', ([mode, vertices]) => drawn(mode, vertices));
  around('drawArrays', ([mode, , vertices]) => drawn(mode, vertices));
  around('texStorage2D', ([, levels, format, width, height]) => stored(levels, format, width, height, 1, 4));
  around('texStorage3D', ([, levels, format, width, height, depth]) => stored(levels, format, width, height, depth, 8));
}

describe('the picture of the demo', () => {
  const stage = new Stage(['--demo', 'layers']);


  it('costs at most twice what the tissue alone on its cloth did', async () => {
    const viewer = await stage.openFirst();
    await viewer.page.addInitScript(countDrawing);
    await viewer.page.reload();
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
    await viewer.close();
  });
});
