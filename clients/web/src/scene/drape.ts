// SPDX-License-Identifier: GPL-3.0-or-later
// The cloth under the tissue: it gives the eye a ground to judge depth by.
import { Box3, CircleGeometry, Color, GLSL3, Mesh, ShaderMaterial, Vector2, Vector3, type IUniform } from 'three';

const DRAPE_VERTEX = /* glsl */ `
out vec2 vAt;
out vec3 vWorld;
void main() {
  vAt = position.xy;
  vec4 world = modelMatrix * vec4(position, 1.0);
  vWorld = world.xyz;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;
const DRAPE_FRAGMENT = /* glsl */ `
precision highp float;
in vec2 vAt;
in vec3 vWorld;
out vec4 fragment;
uniform vec3 drape;
uniform vec3 background;
uniform vec2 extent;
void main() {
  float r = length(vAt);
  vec2 beyond = max(abs(vWorld.xy) - extent, 0.0);
  float contact = 1.0 - 0.5 * exp(-length(beyond) / 0.012);
  float weave = 0.97 + 0.03 * sin(vWorld.x * 2400.0) * sin(vWorld.y * 2400.0);
  vec3 colour = mix(drape * contact * weave, background, smoothstep(0.25, 1.0, r));
  fragment = linearToOutputTexel(vec4(colour, 1.0));
}`;

export class Drape {
  readonly mesh: Mesh<CircleGeometry, ShaderMaterial>;
  private readonly colour: IUniform<Color> = { value: new Color() };
  private readonly extent: IUniform<Vector2> = { value: new Vector2(0.05, 0.05) };

  constructor(background: IUniform<Color>) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: DRAPE_VERTEX,
      fragmentShader: DRAPE_FRAGMENT,
      uniforms: { drape: this.colour, background, extent: this.extent },
    });
    this.mesh = new Mesh(new CircleGeometry(1, 48), material);
    this.mesh.visible = false;
  }

  setTheme(dark: boolean): void {
    if (dark) this.colour.value.setRGB(0.028, 0.105, 0.115);
    else this.colour.value.setRGB(0.16, 0.36, 0.38);
  }

  /** Lies a little under a box. */
  place(box: Box3): void {
    const size = box.getSize(new Vector3());
    const reach = Math.max(size.x, size.y, 0.02);
    this.mesh.scale.setScalar(4 * reach);
    this.mesh.position.set((box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2, box.min.z - Math.max(0.02 * reach, 0.012));
    this.extent.value.set(size.x / 2, size.y / 2);
  }
}
