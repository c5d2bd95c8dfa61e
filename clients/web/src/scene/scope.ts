// SPDX-License-Identifier: GPL-3.0-or-later
// The round picture of an endoscope: dark around a circle, dimmer towards it. What is outside of the circle is not
// shaded, since it is hidden before all else is drawn.
import { BufferGeometry, Float32BufferAttribute, GLSL3, Group, Mesh, ShaderMaterial, Vector3, type IUniform } from 'three';

const AROUND = 96; // sides of the hole: less than a pixel off a circle in a picture of 1000

/** In radii of the circle: where it begins to get dimmer, and where what covers it ends. */
const DIM_FROM = 0.45;
const DIM_TO = 1.02;

const HOLE_VERTEX = /* glsl */ `
uniform vec3 circle;
uniform vec2 size;
void main() { // from the circle outwards beyond the picture
  vec2 at = position.z > 0.5 ? position.xy * 4.0 : position.xy * 1.01 * circle.z / size * 2.0;
  gl_Position = vec4(at, -1.0, 1.0);
}`;
const COVER_VERTEX = /* glsl */ `
uniform vec3 circle;
uniform vec2 size;
void main() { gl_Position = vec4(position.xy * position.z * circle.z / size * 2.0, 0.0, 1.0); }`;
const FRAGMENT = /* glsl */ `
precision highp float;
out vec4 fragment;
uniform vec3 circle;   // middle and radius, pixels
void main() {
  float out_ = length(gl_FragCoord.xy - circle.xy) / circle.z;
  float dim = 0.5 * smoothstep(${DIM_FROM}, 1.0, out_) * out_ * out_;
  float dark = smoothstep(circle.z - 1.5, circle.z + 1.0, out_ * circle.z);
  fragment = vec4(vec3(0.004), max(dim, dark));
}`;

/** Of the picture's shorter side, that the circle is wide. The rest is black, which costs nothing to draw. */
const WIDTH_SHARE = 0.93;

/** Radius of the circle, in halves of the picture's height. */
export function circleRadius(aspect: number): number {
  return WIDTH_SHARE * Math.min(aspect, 1);
}

/** Whether a place of the picture, both coordinates from -1 to 1, is inside of the circle. */
export function inCircle(x: number, y: number, aspect: number): boolean {
  return Math.hypot(x * aspect, y) < circleRadius(aspect);
}

export class Scope {
  readonly group = new Group();
  private readonly circle: IUniform<Vector3> = { value: new Vector3(0, 0, 1) };
  private readonly size: IUniform<Float32Array> = { value: new Float32Array([1, 1]) };

  constructor() {
    const uniforms = { circle: this.circle, size: this.size };
    const add = (geometry: BufferGeometry, vertexShader: string, last: boolean): void => {
      const material = new ShaderMaterial({ glslVersion: GLSL3, vertexShader, fragmentShader: FRAGMENT, uniforms, transparent: last, depthTest: !last, depthWrite: !last });
      const mesh = new Mesh(geometry, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = last ? 100 : -100;
      this.group.add(mesh);
    };
    add(ring(0, 1), HOLE_VERTEX, false);
    add(ring(DIM_FROM, DIM_TO), COVER_VERTEX, true); // no more than that: blending a whole picture takes long in software
  }

  /** In pixels of the drawing. */
  resize(width: number, height: number): void {
    this.circle.value.set(width / 2, height / 2, (circleRadius(width / Math.max(height, 1)) * height) / 2);
    this.size.value.set([width, height]);
  }
}

/** Directions from the middle, with `inner` and `outer` in turn as their third coordinate. */
function ring(inner: number, outer: number): BufferGeometry {
  const position: number[] = [];
  const index: number[] = [];
  for (let i = 0; i < AROUND; i++) {
    const [x, y] = [Math.cos((2 * Math.PI * i) / AROUND), Math.sin((2 * Math.PI * i) / AROUND)];
    position.push(x, y, inner, x, y, outer);
    const [a, b] = [2 * i, 2 * ((i + 1) % AROUND)];
    index.push(a, a + 1, b + 1, a, b + 1, b);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(position, 3));
  geometry.setIndex(index);
  return geometry;
}
