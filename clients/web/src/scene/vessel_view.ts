// SPDX-License-Identifier: GPL-3.0-or-later
// Blood vessels in three.js. What tissue does not cover is drawn as it is. Where a vessel lies close below the surface it
// is drawn once more, faintly, over the tissue, so that a trainee finds it.
import { BufferAttribute, BufferGeometry, DynamicDrawUsage, FrontSide, GLSL3, Group, Mesh, ShaderMaterial } from 'three';

import { makeTube } from '../model/vessel_tube';
import type { VesselState } from '../wire/vessels';
import { COMMON } from './surface_light';
import type { SharedUniforms } from './tissue_view';

const SEEN_M = 0.0015; // of tissue, along the line of sight: a vessel that lies deeper is not seen
const FAINT = 0.34; // how much of the tissue's colour the vessel takes the place of
const OVER_TISSUE = 3; // in the order of drawing: sheets are 2, smoke is 5

const vertex = (moved: string): string => /* glsl */ `
in vec2 look;
out vec3 vWorld;
out vec3 vNormal;
out vec4 vBurn;
out vec3 vMaterial;
out vec2 vLook;
void main() {
  vWorld = vMaterial = position;
  vNormal = normal;
  vBurn = vec4(0.0);
  vLook = look;
  gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
  ${moved}
}`;
const VERTEX = vertex('');
/** Its depth is that of a place nearer to the camera. So tissue hides it only where there is more of it in between. */
const SEEN_VERTEX = vertex(/* glsl */ `
  vec4 nearer = projectionMatrix * viewMatrix * vec4(position + ${SEEN_M} * normalize(cameraPosition - position), 1.0);
  gl_Position.z = nearer.z / nearer.w * gl_Position.w;`);

const FRAGMENT = COMMON + /* glsl */ `
in vec2 vLook;
uniform float faint;
void main() {
  if (dot(vWorld, clip.xyz) > clip.w) discard;
  vec3 view = normalize(cameraPosition - vWorld);
  Surface s;
  s.normal = normalize(vNormal);
  // A wall whose sides lie on each other holds no blood: it is as pale as heated collagen.
  s.colour = mix(vec3(0.72, 0.58, 0.43), vec3(0.52, 0.045, 0.04), smoothstep(0.0, 0.45, vLook.x));
  s.colour = mix(s.colour, vec3(0.13, 0.004, 0.006), vLook.y * smoothstep(0.0, 0.2, vLook.x));
  s.gloss = 60.0;
  s.wet = 0.35 * (1.0 - faint);
  s.alpha = faint > 0.0 ? faint * smoothstep(0.0, 0.6, abs(dot(s.normal, view))) : 1.0;
  vec3 colour = toned(EXPOSURE * shade(s, view));
  if (mapChannel >= 0) colour = vec3(0.5 * dot(colour, vec3(0.3, 0.5, 0.2))); // grey beside colours that stand for a number
  fragment = linearToOutputTexel(vec4(colour, s.alpha));
}`;

interface Drawn {
  geometry: BufferGeometry;
  meshes: Mesh[];
  radiusM: number;
  points: Float32Array;
}

const same = (a: Float32Array, b: Float32Array): boolean => a.length === b.length && a.every((number, i) => number === b[i]);

export class VesselViews {
  readonly group = new Group();
  private readonly drawn: Drawn[] = [];
  private materials: readonly ShaderMaterial[] = []; // made with the first vessel: others need no programs for it

  constructor(private readonly shared: SharedUniforms) {}

  /** Draws these from now on. Says whether the picture changes. */
  show(vessels: readonly VesselState[]): boolean {
    let changed = vessels.length !== this.drawn.length;
    while (this.drawn.length > vessels.length) this.remove();
    vessels.forEach(({ points, radiusM }, i) => {
      const drawn = (this.drawn[i] ??= this.add());
      if (drawn.radiusM === radiusM && same(drawn.points, points)) return;
      Object.assign(drawn, { radiusM, points });
      rebuild(drawn);
      changed = true;
    });
    return changed;
  }

  private add(): Drawn {
    if (this.materials.length === 0) this.materials = [this.makeMaterial(0), this.makeMaterial(FAINT)];
    const geometry = new BufferGeometry();
    const meshes = this.materials.map((material, i) => {
      const mesh = new Mesh(geometry, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = i * OVER_TISSUE;
      return mesh;
    });
    this.group.add(...meshes);
    return { geometry, meshes, radiusM: 0, points: new Float32Array(0) };
  }

  private remove(): void {
    const drawn = this.drawn.pop();
    if (!drawn) return;
    this.group.remove(...drawn.meshes);
    drawn.geometry.dispose();
  }

  private makeMaterial(faint: number): ShaderMaterial {
    return new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: faint > 0 ? SEEN_VERTEX : VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { ...this.shared, faint: { value: faint } },
      side: FrontSide,
      transparent: faint > 0,
      depthWrite: faint === 0,
    });
  }
}

/** The arrays on the card are kept where they have the right length: gaps alone change it. */
function rebuild({ geometry, points, radiusM }: Drawn): void {
  const { index, ...attributes } = makeTube(points, radiusM);
  for (const [name, array] of Object.entries(attributes)) {
    const attribute = geometry.getAttribute(name) as BufferAttribute | undefined;
    if (attribute?.array.length === array.length) {
      attribute.array.set(array);
      attribute.needsUpdate = true;
    } else {
      geometry.setAttribute(name, new BufferAttribute(array, name === 'look' ? 2 : 3).setUsage(DynamicDrawUsage));
    }
  }
  const before = geometry.getIndex();
  if (before?.array.length !== index.length || !index.every((value, i) => value === before.array[i])) geometry.setIndex(new BufferAttribute(index, 1));
}
