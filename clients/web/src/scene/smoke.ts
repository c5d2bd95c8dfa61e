// SPDX-License-Identifier: GPL-3.0-or-later
// Smoke over hot tips that touch tissue: soft points, lit by whatever lights the field.
import { BufferAttribute, BufferGeometry, GLSL3, NormalBlending, Points, ShaderMaterial, Vector3 } from 'three';

import { Puffs } from '../model/puffs';
import type { ToolState } from '../wire/records';
import type { Frame } from '../wire/worker_messages';
import type { ToolView } from './tool_view';

const VERTEX = /* glsl */ `
in float age;
in float seed;
out float vAge;
uniform float scale;
void main() {
  vAge = age;
  vec4 at = viewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * at;
  gl_PointSize = scale * (0.0022 + 0.021 * age + 0.003 * seed) * projectionMatrix[1][1] / max(-at.z, 1e-4);
}`;
const FRAGMENT = /* glsl */ `
precision highp float;
in float vAge;
out vec4 fragment;
uniform vec3 colour;
void main() {
  if (vAge >= 1.0) discard;
  vec2 d = gl_PointCoord - 0.5;
  float soft = smoothstep(0.5, 0.0, length(d));
  float fade = smoothstep(0.0, 0.06, vAge) * (1.0 - vAge) * (1.0 - vAge);
  fragment = linearToOutputTexel(vec4(colour, 0.20 * soft * soft * fade));
}`;
const MOST_S = 1; // longest step: slow machines need up to 0.7 s for a picture, and a page that was hidden makes 7 puffs at most
const REDUCED = '(prefers-reduced-motion: reduce)';

export class Smoke {
  readonly points: Points<BufferGeometry, ShaderMaterial>;
  private readonly puffs = new Puffs();
  private readonly reduced = window.matchMedia(REDUCED);
  private wanted = true;
  private faces = 0; // drawn of the last frame

  constructor() {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(this.puffs.position, 3));
    geometry.setAttribute('age', new BufferAttribute(this.puffs.age, 1));
    geometry.setAttribute('seed', new BufferAttribute(this.puffs.seed, 1));
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { scale: { value: 500 }, colour: { value: new Vector3(0.52, 0.52, 0.53) } },
      transparent: true,
      depthWrite: false,
      blending: NormalBlending,
    });
    this.points = new Points(geometry, material);
    this.points.frustumCulled = false;
    this.points.visible = false;
    this.points.renderOrder = 5;
  }

  /** Number of puffs in the air. */
  get count(): number {
    return this.puffs.count;
  }

  /** The user's setting. Without it, or with reduced motion, there is no smoke. */
  turn(on: boolean): void {
    this.wanted = on;
  }

  resize(pixelHeight: number): void {
    this.points.material.uniforms['scale'].value = pixelHeight / 2;
  }

  /** Starts smoke where faces are removed; a past view has no smoke. */
  watch(frame: Frame): void {
    const faces = Object.values(frame.drawnFaces).reduce((sum, count) => sum + count, 0);
    if (!frame.past && faces < this.faces) this.puffs.burst(this.faces - faces);
    this.faces = faces;
  }

  /** Lets puffs rise and drift, and starts new ones at tips that burn tissue. Returns true if the picture changes. */
  advance(seconds: number, states: readonly ToolState[], views: ReadonlyMap<string, ToolView>): boolean {
    const burning = this.wanted && !this.reduced.matches ? states.filter(({ energized, touchedLayers }) => energized && touchedLayers !== 0) : [];
    const at = burning.flatMap(({ name }) => {
      const position = views.get(name)?.group.position;
      return position ? [[position.x, position.y, position.z] as const] : [];
    });
    const was = this.points.visible;
    this.points.visible = this.puffs.advance(Math.min(seconds, MOST_S), at);
    if (!this.points.visible) return was;
    for (const name of ['position', 'age']) this.points.geometry.getAttribute(name).needsUpdate = true;
    return true;
  }
}
