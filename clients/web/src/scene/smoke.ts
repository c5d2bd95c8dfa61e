// SPDX-License-Identifier: GPL-3.0-or-later
// A little smoke over hot tips that touch tissue.
import { AdditiveBlending, BufferAttribute, BufferGeometry, GLSL3, NormalBlending, Points, ShaderMaterial, Vector3 } from 'three';

const PUFFS = 64;
const LIFE_S = 1.6;
const PUFFS_PER_S = 26;
const RISE_M_S = 0.018;

const VERTEX = /* glsl */ `
in float age;
in float seed;
out float vAge;
uniform float scale;
void main() {
  vAge = age;
  vec4 at = viewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * at;
  gl_PointSize = scale * (0.0025 + 0.010 * age + 0.002 * seed) * projectionMatrix[1][1] / max(-at.z, 1e-4);
}`;
const FRAGMENT = /* glsl */ `
precision highp float;
in float vAge;
out vec4 fragment;
uniform vec3 colour;
void main() {
  vec2 d = gl_PointCoord - 0.5;
  float soft = smoothstep(0.5, 0.0, length(d));
  float fade = smoothstep(0.0, 0.12, vAge) * (1.0 - vAge) * (1.0 - vAge);
  if (vAge >= 1.0) discard;
  fragment = linearToOutputTexel(vec4(colour, 0.17 * soft * soft * fade));
}`;

export class Smoke {
  readonly points: Points<BufferGeometry, ShaderMaterial>;
  private readonly position = new Float32Array(3 * PUFFS);
  private readonly age = new Float32Array(PUFFS).fill(1);
  private readonly seed = Float32Array.from({ length: PUFFS }, () => Math.random());
  private next = 0;
  private owed = 0;

  constructor() {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(this.position, 3));
    geometry.setAttribute('age', new BufferAttribute(this.age, 1));
    geometry.setAttribute('seed', new BufferAttribute(this.seed, 1));
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { scale: { value: 500 }, colour: { value: new Vector3(0.62, 0.63, 0.66) } },
      transparent: true,
      depthWrite: false,
      blending: NormalBlending,
    });
    this.points = new Points(geometry, material);
    this.points.frustumCulled = false;
    this.points.renderOrder = 5;
  }

  setLight(dark: boolean): void {
    this.points.material.blending = dark ? AdditiveBlending : NormalBlending;
    this.points.material.needsUpdate = true;
  }

  resize(pixelHeight: number): void {
    this.points.material.uniforms['scale'].value = pixelHeight / 2;
  }

  /** Lets puffs rise, and starts new ones at the sources. True while any is seen. */
  advance(seconds: number, sources: readonly Vector3[]): boolean {
    let alive = false;
    for (let i = 0; i < PUFFS; i++) {
      if (this.age[i] >= 1) continue;
      this.age[i] = Math.min(this.age[i] + seconds / (LIFE_S * (0.7 + 0.6 * this.seed[i])), 1);
      this.position[3 * i] += 0.004 * (this.seed[i] - 0.5) * seconds * 2;
      this.position[3 * i + 1] += 0.003 * (this.seed[(i + 1) % PUFFS] - 0.5) * seconds * 2;
      this.position[3 * i + 2] += RISE_M_S * seconds;
      alive = true;
    }
    this.owed = sources.length > 0 ? this.owed + PUFFS_PER_S * seconds : 0;
    for (; this.owed >= 1; this.owed--) {
      const source = sources[this.next % sources.length];
      source.toArray(this.position, 3 * this.next);
      this.age[this.next] = 0;
      this.next = (this.next + 1) % PUFFS;
      alive = true;
    }
    if (alive) {
      this.points.geometry.getAttribute('position').needsUpdate = true;
      this.points.geometry.getAttribute('age').needsUpdate = true;
    }
    return alive;
  }
}
