// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that the drawn instrument is the one of the core's computation. Every drawn surface must lie on or in the
// core's. Every point of the core's surface must be drawn, within a tenth of a millimetre.
import { spawnSync } from 'node:child_process';

import { Box3, Matrix4, Mesh, Triangle, Vector3, type BufferGeometry, type Color, type ShaderMaterial } from 'three';

import { hasJaws, type Shape } from '../../../../clients/web/src/model/tool_parts';
import { ToolView } from '../../../../clients/web/src/scene/tool_view';
import { TOOL_SHAPES } from '../../../../clients/web/src/wire/messages.gen';

const NEAR_M = 1e-4;
const SAMPLES = 250;
const STEPS = 12; // moves of a point towards the core's surface, by its distance along the gradient
const ON_SURFACE_M = 1e-5;
const NO_AREA_M2 = 1e-16;
const REACH_M = 0.03; // radius around the tip: outside there is only the shaft
const JAWS = [0, 0.5, 1];
/** Sizes of default instruments and of slim ones. */
const SIZES: readonly (readonly [number, number, number])[] = [[0.003, 0.008, 0.0025], [0.0008, 0.01, 0.0025], [0.0015, 0.004, 0.001]];

type Sizes = (typeof SIZES)[number];
/** A point in the tool's frame, which the core moves STEPS times towards its surface. */
interface Asked {
  jaw: number;
  part: number;
  point: Vector3;
  steps: number;
}
/** The point's final position, and its distance there. */
interface Answer {
  distance: number;
  point: Vector3;
}
interface Drawn {
  triangle: Triangle;
  box: Box3;
}

/** Returns a generator that gives the same numbers in every run (Park and Miller). */
function makeRandom(): () => number {
  let state = 1;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

/** Returns the core's answers for all points, from one run of its program, because starting it takes longer than
 * answering. */
function askCore(shape: Shape, [hot, tip, shaft]: Sizes, asked: readonly Asked[]): Answer[] {
  const program = process.env['CAUTERY_TOOL_DISTANCES'];
  if (program === undefined) throw new Error('CAUTERY_TOOL_DISTANCES names no program');
  const head = [TOOL_SHAPES.indexOf(shape), hot, tip, shaft].join(' ');
  const input = asked.map(({ jaw, part, point: { x, y, z }, steps }) => `${head} ${jaw} ${part} ${x} ${y} ${z} ${steps}\n`).join('');
  const { stdout, status } = spawnSync(program, { input, encoding: 'utf8', maxBuffer: 1 << 26 });
  expect(status).toBe(0);
  const answers = stdout.trim().split('\n').map((line) => {
    const [distance, x, y, z] = line.split(' ').map(Number);
    return { distance, point: new Vector3(x, y, z) };
  });
  expect(answers).toHaveLength(asked.length);
  return answers;
}

/** Returns the triangles of the hot or the cold part in the tool's frame. */
function drawnTriangles(view: ToolView, jaw: number, hot: boolean): Triangle[] {
  view.set([0, 0, 0], [1, 0, 0, 0], jaw, 0);
  view.group.updateMatrixWorld(true);
  const triangles: Triangle[] = [];
  view.group.traverse((object) => {
    if (object instanceof Mesh && object.userData['hot'] === hot) add(triangles, object.geometry as BufferGeometry, object.matrixWorld);
  });
  return triangles;
}

function add(triangles: Triangle[], geometry: BufferGeometry, matrix: Matrix4): void {
  const position = geometry.getAttribute('position');
  const index = geometry.getIndex()!;
  const corner = (i: number): Vector3 => new Vector3().fromBufferAttribute(position, index.getX(i)).applyMatrix4(matrix);
  for (let i = 0; i < index.count; i += 3) {
    const triangle = new Triangle(corner(i), corner(i + 1), corner(i + 2));
    // leaves out triangles of no area: a plate that is fully rounded has a flat of no width
    if (triangle.getArea() > NO_AREA_M2) triangles.push(triangle);
  }
}

function sampleDrawn(triangles: readonly Triangle[], random: () => number): Vector3[] {
  const areas = triangles.map((triangle) => triangle.getArea());
  const whole = areas.reduce((sum, area) => sum + area, 0);
  const points: Vector3[] = [];
  let carried = 0;
  triangles.forEach(({ a, b, c }, i) => {
    for (carried += (SAMPLES * areas[i]) / whole; carried >= 1; carried--) {
      const [u, v] = [random(), random()].sort((one, other) => one - other);
      points.push(a.clone().multiplyScalar(u).addScaledVector(b, v - u).addScaledVector(c, 1 - v));
    }
  });
  return points;
}

/** Returns points all around the tip. */
function sampleAround(random: () => number): Vector3[] {
  const away = (): number => REACH_M * (2 * random() - 1);
  return Array.from({ length: SAMPLES }, () => new Vector3(away(), away(), away()));
}

/** Returns the answers that reached the core's surface near the tip. */
function onSurface(answers: readonly Answer[]): Vector3[] {
  return answers.filter(({ distance, point }) => Math.abs(distance) < ON_SURFACE_M && point.length() < REACH_M).map(({ point }) => point);
}

function boxed(triangles: readonly Triangle[]): Drawn[] {
  return triangles.map((triangle) => ({ triangle, box: new Box3().setFromPoints([triangle.a, triangle.b, triangle.c]) }));
}

/** Returns the least distance to the drawn triangles. A triangle is no nearer than its box, so most need no
 * computation. */
function distanceTo(drawn: readonly Drawn[], point: Vector3): number {
  const nearest = new Vector3();
  let least = Infinity; // the square of the least distance so far
  for (const { triangle, box } of drawn) {
    if (box.clampPoint(point, nearest).distanceToSquared(point) >= least) continue;
    least = Math.min(least, triangle.closestPointToPoint(point, nearest).distanceToSquared(point));
  }
  return Math.sqrt(least);
}

describe('a hook', () => {
  it('has insulation on all but its wire', () => {
    const view = new ToolView({ name: 'it', shape: 'hook' }, { value: new Vector3() });
    const brightness = (hot: boolean): number[] => {
      const found: number[] = [];
      view.group.traverse((object) => {
        if (!(object instanceof Mesh) || object.userData['hot'] !== hot) return;
        const { r, g, b } = (object.material as ShaderMaterial).uniforms['base'].value as Color;
        found.push((r + g + b) / 3);
      });
      return found;
    };
    expect(brightness(false)).toHaveLength(2);
    expect(Math.max(...brightness(false))).toBeLessThan(0.1);
    expect(Math.min(...brightness(true))).toBeGreaterThan(0.5);
  });
});

describe.each(TOOL_SHAPES)('the drawn %s', (shape) => {
  it.each(SIZES)('is the core’s, hot radius %f m, tip %f m, shaft %f m', (...sizes) => {
    const random = makeRandom();
    const [hot_radius_m, tip_length_m, shaft_radius_m] = sizes;
    const view = new ToolView({ name: 'it', shape, hot_radius_m, tip_length_m, shaft_radius_m }, { value: new Vector3() });
    const parts = [];
    for (const jaw of hasJaws(shape) ? JAWS : [1]) {
      for (const part of [0, 1]) {
        const triangles = drawnTriangles(view, jaw, part === 0);
        if (triangles.length === 0) expect([shape, part]).toEqual(['grasper', 0]);
        else parts.push({ jaw, part, triangles, drawn: sampleDrawn(triangles, random), around: sampleAround(random) });
      }
    }
    const answers = askCore(shape, sizes, parts.flatMap(({ jaw, part, drawn, around }) => [
      ...drawn.map((point) => ({ jaw, part, point, steps: 0 })), ...around.map((point) => ({ jaw, part, point, steps: STEPS })),
    ]));
    for (const { jaw, part, triangles, drawn, around } of parts) {
      const outside = Math.max(...answers.splice(0, drawn.length).map(({ distance }) => distance));
      const surface = onSurface(answers.splice(0, around.length));
      const boxes = boxed(triangles);
      const missing = Math.max(...surface.map((point) => distanceTo(boxes, point)));
      const where = `jaw ${jaw}, ${part === 0 ? 'hot' : 'cold'}`;
      expect(surface.length, where).toBeGreaterThan(SAMPLES / 20);
      expect(outside, `${where}: drawn outside of the core’s`).toBeLessThan(NEAR_M);
      expect(missing, `${where}: not drawn`).toBeLessThan(NEAR_M);
    }
  });
});
