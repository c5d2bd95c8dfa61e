// SPDX-License-Identifier: GPL-3.0-or-later
// One instrument: its solids from the definition, jaws that turn, metal that is a trace warmer when hot. As a
// ghost it is where its driver wants it while tissue keeps it elsewhere, which is inside the tissue or behind
// it: so a ghost is seen through everything, as a rim of light around its solids.
import { BufferGeometry, Color, GLSL3, Group, Mesh, ShaderMaterial, Vector3, type IUniform } from 'three';

import { toolParts, toolSizes, type ToolPart } from '../model/tool_parts';
import { solidGeometry } from './tool_solids';
import type { Tool } from '../wire/messages.gen';

const vertex = (moved: string): string => /* glsl */ `
out vec3 vNormalWorld;
out vec3 vWorld;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vWorld = world.xyz;
  vNormalWorld = mat3(modelMatrix) * normal;
  gl_Position = projectionMatrix * viewMatrix * world;
  ${moved}
}`;
const VERTEX = vertex('');
// Drawing order: in front of the field, and behind the black around a round picture.
const GHOST_VERTEX = vertex('gl_Position.z = -0.999 * gl_Position.w;');

// Brushed steel under a lamp in a dim room: the room is a gradient that the metal mirrors.
const FRAGMENT = /* glsl */ `
precision highp float;
in vec3 vNormalWorld;
in vec3 vWorld;
out vec4 fragment;
uniform vec3 light;
uniform vec3 base;
uniform float mirror;
uniform float heat;
void main() {
  vec3 normal = normalize(vNormalWorld);
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 toLight = normalize(light - vWorld);
  vec3 bounced = reflect(-view, normal);
  float room = 0.10 + 0.55 * smoothstep(-0.2, 0.9, bounced.z) + 0.35 * smoothstep(0.15, 0.0, abs(bounced.z - 0.25));
  float diffuse = clamp((dot(normal, toLight) + 0.2) / 1.2, 0.0, 1.0);
  float shine = pow(max(dot(normal, normalize(toLight + view)), 0.0), 70.0);
  vec3 colour = base * mix(0.22 + 0.8 * diffuse, room + 0.25 * diffuse, mirror) + shine * (0.3 + mirror) * 0.7;
  // Steel glows only far above what cuts tissue: a trace of warmth, no colour of its own.
  colour *= mix(vec3(1.0), vec3(1.04, 0.97, 0.88), heat);
  colour += heat * vec3(0.020, 0.008, 0.0);
  fragment = linearToOutputTexel(vec4(colour, 1.0));
}`;

const GHOST_FRAGMENT = /* glsl */ `
precision highp float;
in vec3 vNormalWorld;
in vec3 vWorld;
out vec4 fragment;
void main() {
  float facing = abs(dot(normalize(vNormalWorld), normalize(cameraPosition - vWorld)));
  // Of its own light, and dense soon within the rim: tissue under a lamp at the lens is as bright as it is.
  float rim = smoothstep(0.10, 0.70, 1.0 - facing);
  fragment = linearToOutputTexel(vec4(vec3(0.02, 0.70, 1.0), 0.16 + 0.80 * rim));
}`;
/** In some shapes the rod is as wide as its sleeve. It is drawn thinner by this much, so that no two surfaces coincide
 * and flicker. */
const UNDER_SLEEVE_M = 3e-5;
const LAST = 10; // of what is drawn: over tissue, cloth and instruments

export class ToolView {
  readonly group = new Group();
  private readonly jaws: { pivot: Group; side: number; share: number }[] = [];
  private readonly heat: IUniform<number> = { value: 0 };
  private shown: readonly number[] = [];
  private readonly still: Mesh[] = []; // what does not turn with jaws
  private readonly materials: ShaderMaterial[] = [];
  private readonly jawOpen: number;
  private readonly tip: number;

  constructor(
    readonly definition: Tool,
    light: IUniform<Vector3>,
    private readonly ghost = false,
  ) {
    const sizes = toolSizes(definition);
    this.jawOpen = sizes.jawOpen;
    this.tip = sizes.tip;
    const steel = this.makeMaterial(light, new Color(0.62, 0.64, 0.67), 0.85, { value: 0 });
    const hot = this.makeMaterial(light, new Color(0.70, 0.66, 0.60), 0.7, this.heat);
    const sleeve = this.makeMaterial(light, new Color(0.035, 0.038, 0.045), 0.12, { value: 0 });
    sleeve.polygonOffset = true; // over the end of what it holds, which may be as wide
    sleeve.polygonOffsetFactor = sleeve.polygonOffsetUnits = -2;
    const neck = this.makeMaterial(light, new Color(0.060, 0.066, 0.078), 0.10, { value: 0 });
    const parts = toolParts(definition);
    for (const part of parts) {
      const isShaft = part === parts.at(-1);
      const under = part.solid === 'capsule' && !part.hot && !isShaft ? { ...part, radius: part.radius - UNDER_SLEEVE_M } : part;
      // The neck of a hook is insulated like its shaft: only the wire is bare.
      const mesh = new Mesh(solidGeometry(under), part.hot ? hot : isShaft ? sleeve : definition.shape === 'hook' ? neck : steel);
      mesh.userData['hot'] = part.hot;
      this.place(mesh, part);
    }
  }

  /** Says whether anything is drawn otherwise than before; heat is 0 cold to 1 glowing. */
  set(position: readonly number[], rotation: readonly number[], jaw: number, heat: number, jawsAlone = false): boolean {
    const now = [...position, ...rotation, jaw, heat, Number(jawsAlone)];
    if (this.group.visible && now.every((value, i) => value === this.shown[i])) return false;
    this.shown = now;
    const [w, x, y, z] = rotation;
    this.group.visible = true;
    this.group.position.set(position[0], position[1], position[2]);
    this.group.quaternion.set(x, y, z, w);
    this.setJaw(jaw);
    this.heat.value = heat;
    for (const mesh of this.still) mesh.visible = !jawsAlone;
    return true;
  }

  /** How far a jaw's end goes by a share of the opening; 0 without jaws. */
  jawWayM(share: number): number {
    return this.jaws.length === 0 ? 0 : Math.abs(share) * this.jawOpen * this.tip;
  }

  /** Says whether it was drawn. */
  hide(): boolean {
    const was = this.group.visible;
    this.group.visible = false;
    return was;
  }

  dispose(): void {
    this.group.traverse((object) => {
      if (object instanceof Mesh) (object.geometry as BufferGeometry).dispose();
    });
    for (const material of this.materials) material.dispose();
  }

  private setJaw(jaw: number): void {
    for (const { pivot, side, share } of this.jaws) {
      // A jaw's own frame has its body on +x; the mirrored jaw is turned by half a turn about z.
      pivot.rotation.set(0, -jaw * share * this.jawOpen, 0);
      pivot.parent!.rotation.set(0, 0, side > 0 ? 0 : Math.PI);
    }
  }

  private place(mesh: Mesh, part: ToolPart): void {
    if (this.ghost) mesh.renderOrder = LAST;
    if (!part.jaw) {
      this.still.push(mesh);
      this.group.add(mesh);
      return;
    }
    const { side, share, hinge } = part.jaw;
    const hingeFrame = new Group();
    const pivot = new Group();
    hingeFrame.position.z = hinge;
    pivot.add(mesh);
    hingeFrame.add(pivot);
    this.group.add(hingeFrame);
    this.jaws.push({ pivot, side, share });
  }

  private makeMaterial(light: IUniform<Vector3>, base: Color, mirror: number, heat: IUniform<number>): ShaderMaterial {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: this.ghost ? GHOST_VERTEX : VERTEX,
      fragmentShader: this.ghost ? GHOST_FRAGMENT : FRAGMENT,
      uniforms: { light, base: { value: base }, mirror: { value: mirror }, heat },
      transparent: this.ghost,
      depthWrite: !this.ghost,
    });
    this.materials.push(material);
    return material;
  }
}
