// SPDX-License-Identifier: GPL-3.0-or-later
// One instrument: its solids from the definition, jaws that turn, metal that glows a little when hot.
import {
  BoxGeometry,
  BufferGeometry,
  CapsuleGeometry,
  Color,
  GLSL3,
  Group,
  Mesh,
  Quaternion,
  ShaderMaterial,
  SphereGeometry,
  TubeGeometry,
  Vector3,
  Curve,
  type IUniform,
} from 'three';

import { toolParts, toolSizes, type ToolPart } from '../model/tool_parts';
import type { Tool } from '../wire/messages.gen';

const VERTEX = /* glsl */ `
out vec3 vNormalWorld;
out vec3 vWorld;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vWorld = world.xyz;
  vNormalWorld = mat3(modelMatrix) * normal;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

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
  colour = mix(colour, vec3(1.0, 0.42, 0.12) * (0.5 + 0.5 * diffuse), 0.55 * heat) + heat * vec3(0.35, 0.09, 0.01);
  fragment = linearToOutputTexel(vec4(colour, 1.0));
}`;

class QuarterArc extends Curve<Vector3> {
  constructor(
    private readonly center: readonly [number, number, number],
    private readonly bend: number,
  ) {
    super();
  }

  override getPoint(t: number, target = new Vector3()): Vector3 {
    const angle = (Math.PI / 2) * t;
    const [x, y, z] = this.center;
    return target.set(x - this.bend * Math.sin(angle), y, z - this.bend * Math.cos(angle));
  }
}

const Y = new Vector3(0, 1, 0);

function capsule(part: ToolPart & { solid: 'capsule' }): BufferGeometry {
  const from = new Vector3(...part.from);
  const along = new Vector3(...part.to).sub(from);
  const length = along.length();
  const geometry = length > 0 ? new CapsuleGeometry(part.radius, length, 8, 20) : new SphereGeometry(part.radius, 24, 16);
  if (length > 0) geometry.applyQuaternion(new Quaternion().setFromUnitVectors(Y, along.clone().normalize()));
  return geometry.translate(from.x + along.x / 2, from.y + along.y / 2, from.z + along.z / 2);
}

/** A box whose vertices are pushed onto its rounded hull. */
function plate(part: ToolPart & { solid: 'plate' }): BufferGeometry {
  const [least, most] = [new Vector3(...part.least), new Vector3(...part.most)];
  const size = most.clone().sub(least);
  const center = least.clone().add(most).multiplyScalar(0.5);
  const geometry = new BoxGeometry(size.x, size.y, size.z, 6, 6, 12);
  const core = size.multiplyScalar(0.5).addScalar(-part.rounding).max(new Vector3());
  const position = geometry.getAttribute('position');
  const normal = geometry.getAttribute('normal');
  const at = new Vector3();
  for (let i = 0; i < position.count; i++) {
    at.fromBufferAttribute(position, i);
    const inner = at.clone().clamp(core.clone().negate(), core);
    const out = at.clone().sub(inner).normalize();
    at.copy(inner).addScaledVector(out, part.rounding);
    position.setXYZ(i, at.x, at.y, at.z);
    normal.setXYZ(i, out.x, out.y, out.z);
  }
  return geometry.translate(center.x, center.y, center.z);
}

function solid(part: ToolPart): BufferGeometry {
  if (part.solid === 'capsule') return capsule(part);
  if (part.solid === 'plate') return plate(part);
  return new TubeGeometry(new QuarterArc(part.center, part.bend), 14, part.radius, 16);
}

export class ToolView {
  readonly group = new Group();
  private readonly jaws: { pivot: Group; side: number; share: number }[] = [];
  private readonly heat: IUniform<number> = { value: 0 };
  private shown: readonly number[] = [];
  private readonly materials: ShaderMaterial[] = [];
  private readonly jawOpen: number;

  constructor(
    readonly definition: Tool,
    light: IUniform<Vector3>,
  ) {
    this.jawOpen = toolSizes(definition).jawOpen;
    const steel = this.makeMaterial(light, new Color(0.62, 0.64, 0.67), 0.85, { value: 0 });
    const hot = this.makeMaterial(light, new Color(0.70, 0.66, 0.60), 0.7, this.heat);
    const sleeve = this.makeMaterial(light, new Color(0.035, 0.038, 0.045), 0.12, { value: 0 });
    for (const part of toolParts(definition)) {
      const isShaft = part.solid === 'capsule' && !part.hot && !part.jaw;
      const mesh = new Mesh(solid(part), part.hot ? hot : isShaft ? sleeve : steel);
      this.place(mesh, part);
    }
  }

  /** Says whether anything is drawn otherwise than before; heat is 0 cold to 1 glowing. */
  set(position: readonly number[], rotation: readonly number[], jaw: number, heat: number): boolean {
    const now = [...position, ...rotation, jaw, heat];
    if (this.group.visible && now.every((value, i) => value === this.shown[i])) return false;
    this.shown = now;
    const [w, x, y, z] = rotation;
    this.group.visible = true;
    this.group.position.set(position[0], position[1], position[2]);
    this.group.quaternion.set(x, y, z, w);
    this.setJaw(jaw);
    this.heat.value = heat;
    return true;
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
    if (!part.jaw) {
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
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { light, base: { value: base }, mirror: { value: mirror }, heat },
    });
    this.materials.push(material);
    return material;
  }
}
