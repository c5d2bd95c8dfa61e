// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the cost of the body around the tissue, open and through a trocar: draw calls, triangles and bytes of textures.
// They are compared with those of the plain scene, which is tissue and instruments over a cloth.
import { readdirSync, readFileSync } from 'node:fs';

import { Stage } from './stage';
import { ViewerPage } from './viewer_page';

/** Bytes of the textures of the plain scene: a volume of noise of 48 cubed and a row of colours. */
const PLAIN_TEXTURE_BYTES = 48 ** 3 + 4 * 256;
const TIMES_MORE = 2;
/** Largest ratio of the pictures' times, in software: processor time of the process that draws, with the page's
 * other layers. */
const TIMES_LONGER = 1.5;
// Numbers of compared pairs of pictures. Other programs make a picture more expensive, never cheaper, so the cheapest
// picture of each kind is used. More pairs are drawn on a busy machine, until the more expensive kind has had its
// chance.
const PAIRS_MIN = 12;
const PAIRS_MAX = 60;

type Kind = 'plain' | 'open' | 'trocar';

interface Weight {
  /** leaves out what the plain scene does not have */
  plain: boolean;
  calls: number;
  triangles: number;
  /** bytes of all textures since the page came up, without those of the pictures' size */
  textureBytes: number;
  pictures: number;
}
declare global {
  interface Window {
    weight: Weight;
  }
}

/** In the page, before its scripts: counts the page's calls of WebGL. */
function weigh(): void {
  const weight: Weight = { plain: false, calls: 0, triangles: 0, textureBytes: 0, pictures: 0 };
  window.weight = weight;
  performance.now = () => 0; // otherwise slow pictures would get coarser
  // Texts that only the shaders of flesh, skin, sheath, edge and fringe have.
  const BODY = ['float zone = 3.0', 'skinned(n(vMaterial', 'uniform vec4 below', 'mix(1.15, 0.55, vTip)', 'thread < 0.47'];
  const gl = WebGL2RenderingContext.prototype;
  const sources = new WeakMap<WebGLShader, string>();
  const ofBody = new WeakSet<WebGLProgram>();
  let inBody = false;
  const before = <K extends keyof WebGL2RenderingContext>(name: K, look: (...given: never[]) => unknown): void => {
    const real = gl[name] as (...given: unknown[]) => unknown;
    (gl as unknown as Record<string, unknown>)[name] = function (this: WebGL2RenderingContext, ...given: never[]): unknown {
      return look.apply(this, given) === false ? undefined : real.apply(this, given);
    };
  };
  const drawn = (mode: number, count: number): boolean => {
    if (weight.plain && inBody) return false;
    weight.calls++;
    if (mode === gl.TRIANGLES) weight.triangles += count / 3;
    return true;
  };
  const stored = (format: number, ...sizes: number[]): void => {
    weight.textureBytes += (format === gl.R8 || format === gl.RED ? 1 : 4) * sizes.reduce((product, size) => product * size, 1);
  };
  before('shaderSource', (shader: WebGLShader, source: string) => sources.set(shader, source));
  before('attachShader', (program: WebGLProgram, shader: WebGLShader) => {
    if (BODY.some((mark) => sources.get(shader)?.includes(mark))) ofBody.add(program);
  });
  before('useProgram', (program: WebGLProgram | null) => void (inBody = program !== null && ofBody.has(program)));
  before('drawElements', (mode: number, count: number) => drawn(mode, count));
  before('drawArrays', (mode: number, _first: number, count: number) => drawn(mode, count));
  const levels = (count: number, format: number, sizes: number[]): void => {
    for (let level = 0; level < count; level++) stored(format, ...sizes.map((size) => Math.max(1, size >> level)));
  };
  before('texStorage2D', (_target: number, count: number, format: number, w: number, h: number) => levels(count, format, [w, h]));
  before('texStorage3D', (_target: number, count: number, format: number, w: number, h: number, d: number) => levels(count, format, [w, h, d]));
  before('texImage2D', (...[, , format, w, h]: number[]) => {
    if (typeof h === 'number') stored(format, w, h);
  });
  before('texImage3D', (...[, , format, w, h, d]: number[]) => stored(format, w, h, d));
  before('clear', () => {
    weight.calls = weight.triangles = 0;
  });
  before('fenceSync', () => weight.pictures++);
}

describe('the weight of a picture', () => {
  const stage = new Stage(['--demo', 'layers']);
  let viewer: ViewerPage;
  let drawer: number;

  const choose = async (kind: Kind): Promise<void> => {
    await viewer.page.locator('#operate select[name=field]').selectOption(kind === 'trocar' ? 'trocar' : 'open');
    await viewer.until(() => window.cautery.idle, null, 'the field is chosen');
  };

  /** Returns the cost of the next picture, of a paused session. */
  const next = async (kind: Kind): Promise<Weight> => {
    const { page } = viewer;
    const before = await page.evaluate((left) => {
      window.weight.plain = left;
      return window.weight.pictures;
    }, kind === 'plain');
    await page.mouse.wheel(0, 1); // a minimal change of the view, so that the picture is drawn
    await viewer.until((count) => window.weight.pictures > count && window.cautery.idle, before, 'another picture is there');
    return page.evaluate(() => ({ ...window.weight }));
  };

  /** Returns the processor seconds of the next picture, in all threads of the process that draws. */
  const cost = async (kind: Kind): Promise<number> => {
    const spent = (): number => readdirSync(`/proc/${drawer}/task`).reduce((sum, thread) => sum + 1e-9 * Number(readFileSync(`/proc/${drawer}/task/${thread}/schedstat`, 'utf8').split(' ')[0]), 0);
    await choose(kind);
    const before = spent();
    await next(kind);
    return spent() - before;
  };

  beforeAll(async () => {
    viewer = await ViewerPage.openFirst(stage.browser, 'about:blank', { viewport: { width: 800, height: 560 } });
    await viewer.page.addInitScript(weigh);
    await viewer.page.goto(stage.daemon.url);
    viewer.complaints.length = 0; // these complaints are of the blank page, which has no storage
    await viewer.live('d1-layers');
    const processes = await stage.browser.newBrowserCDPSession();
    const { processInfo } = await processes.send('SystemInfo.getProcessInfo');
    drawer = processInfo.find(({ type }) => type === 'GPU')!.id; // it exists, because it has drawn the page
    await viewer.pause();
    await viewer.page.mouse.move(60, 200); // beside the tissue the wheel moves the camera
    await viewer.page.keyboard.down('Control');
  });

  it.each(['open', 'trocar'] as const)('is no more than twice that of the plain scene in calls, triangles and textures, %s', async (kind) => {
    await choose('plain');
    const plain = await next('plain');
    await choose(kind);
    const whole = await next(kind);
    process.stdout.write(`${kind}: calls ${plain.calls} -> ${whole.calls}, triangles ${plain.triangles} -> ${whole.triangles}, texture bytes ${PLAIN_TEXTURE_BYTES} -> ${whole.textureBytes}\n`);
    expect(plain.triangles).toBeGreaterThan(6000);
    expect(whole.calls).toBeGreaterThan(plain.calls);
    expect(whole.calls).toBeLessThanOrEqual(TIMES_MORE * plain.calls);
    expect(whole.triangles).toBeLessThanOrEqual(TIMES_MORE * plain.triangles);
    expect(whole.textureBytes).toBeLessThanOrEqual(TIMES_MORE * PLAIN_TEXTURE_BYTES);
  });

  it('takes no more than half as long again to draw in software', async () => {
    const least: Record<Kind, number> = { plain: Infinity, open: Infinity, trocar: Infinity };
    const dearer = (): number => Math.max(least.open, least.trocar);
    let rounds = 0;
    while (rounds < PAIRS_MIN || (rounds < PAIRS_MAX && dearer() > TIMES_LONGER * least.plain)) {
      for (const kind of ['plain', 'open', 'trocar'] as const) least[kind] = Math.min(least[kind], await cost(kind));
      rounds++;
    }
    const { plain } = least;
    for (const kind of ['open', 'trocar'] as const)
      process.stdout.write(`a picture in software, ${kind}: ${(1000 * least[kind]).toFixed(0)} ms of the processor, ${(least[kind] / plain).toFixed(2)} times the plain scene's, the least of ${rounds}\n`);
    expect(plain).toBeGreaterThan(0.01);
    expect(dearer()).toBeLessThanOrEqual(TIMES_LONGER * plain);
    expect(viewer.complaints).toEqual([]);
    await viewer.close();
  });
});
