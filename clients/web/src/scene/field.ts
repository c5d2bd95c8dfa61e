// SPDX-License-Identifier: GPL-3.0-or-later
// The operative field around the tissue: a bed that it lies on, and flesh around it. In the open view this is a wall up
// to the skin, and a cloth with a window; through a trocar it is tissue of the same kind on and on. Under tissue that
// hangs freely there is a cloth alone.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, FrontSide, GLSL3, Group, Mesh, ShaderMaterial, type IUniform, type Side } from 'three';

import { Bed } from '../model/bed';
import { clothAround, clothUnder, fleshAround, sheathAround, ZONES, type FieldShape, type Sheath, type Surroundings } from '../model/field_shape';
import type { Joined } from '../wire/worker_messages';
import { VERTEX } from './surface_light';
import { FRAGMENTS } from './tissue_shader';
import type { SharedUniforms } from './tissue_view';

function geometryOf({ position, zone, index }: FieldShape, mostZone: number): BufferGeometry {
  const geometry = new BufferGeometry();
  const burn = new Float32Array(4 * zone.length); // unburnt
  zone.forEach((value, i) => (burn[4 * i + 3] = value / mostZone));
  geometry.setAttribute('position', new BufferAttribute(position, 3));
  geometry.setAttribute('material', new BufferAttribute(position.slice(), 3));
  geometry.setAttribute('burn', new BufferAttribute(burn, 4));
  geometry.setIndex(new BufferAttribute(index, 1));
  geometry.computeVertexNormals();
  return geometry;
}

/** The tissue's own pattern goes on. */
function continued(geometry: BufferGeometry, { origin, alongX, alongY }: Sheath): BufferGeometry {
  const [position, material] = [geometry.getAttribute('position'), geometry.getAttribute('material')];
  for (let v = 0; v < position.count; v++)
    for (let c = 0; c < 3; c++) material.setComponent(v, c, origin[c] + alongX[c] * position.getX(v) + alongY[c] * position.getY(v));
  return geometry;
}

export class Field {
  readonly group = new Group();
  private readonly colour: IUniform<Color> = { value: new Color() };
  private readonly filmed: IUniform<number> = { value: 1 };
  private readonly bedded: Mesh<BufferGeometry, ShaderMaterial>;
  private readonly flesh: Mesh<BufferGeometry, ShaderMaterial>;
  private readonly sheath: Mesh<BufferGeometry, ShaderMaterial>;
  private readonly cloth: Mesh<BufferGeometry, ShaderMaterial>;
  private bed: Bed | null = null;
  private around: Surroundings | null = null;
  private trocar = true;

  constructor(shared: SharedUniforms, background: IUniform<Color>) {
    const make = (fragmentShader: string, uniforms: Record<string, IUniform>, side: Side = DoubleSide): Mesh<BufferGeometry, ShaderMaterial> => {
      const material = new ShaderMaterial({ glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader, uniforms, side });
      const mesh = new Mesh(new BufferGeometry(), material);
      mesh.frustumCulled = false;
      this.group.add(mesh);
      return mesh;
    };
    this.bedded = make(FRAGMENTS.flesh, shared);
    this.flesh = make(FRAGMENTS.flesh, shared);
    this.sheath = make(FRAGMENTS.sheath, { ...shared, filmed: this.filmed }, FrontSide); // seen from within the body alone
    this.cloth = make(FRAGMENTS.cloth, { ...shared, cloth: this.colour, background });
    // After what lies over them, so that what is hidden is not shaded: much of the flesh is under the cloth.
    this.cloth.renderOrder = 2;
    this.flesh.renderOrder = this.bedded.renderOrder = this.sheath.renderOrder = 3;
    this.group.visible = false;
  }

  setTheme(dark: boolean): void {
    if (dark) this.colour.value.setRGB(0.028, 0.15, 0.165);
    else this.colour.value.setRGB(0.075, 0.30, 0.33);
  }

  /** Through a trocar, or open. */
  setTrocar(trocar: boolean): void {
    this.trocar = trocar;
    this.show();
  }

  /** null: there is no tissue */
  place(joined: Joined | null): void {
    const around = (this.around = joined?.surroundings ?? null);
    this.bed = null;
    this.show();
    if (!joined || !around) return;
    for (const mesh of [this.bedded, this.flesh, this.sheath, this.cloth]) mesh.geometry.dispose();
    this.cloth.geometry = geometryOf(around.inBody ? clothAround(around) : clothUnder(around), 1);
    if (!around.inBody) return;
    this.bed = new Bed(around, joined.rest);
    this.bedded.geometry = geometryOf(this.bed.shape, ZONES.most);
    this.flesh.geometry = geometryOf(fleshAround(around), ZONES.most);
    this.sheath.geometry = continued(geometryOf(sheathAround(around), 1), around.sheath);
    this.filmed.value = Number(around.sheath.filmed);
  }

  /** Positions of the tissue's vertices, m. */
  follow(position: Float32Array): void {
    if (!this.bed?.follow(position)) return;
    this.bedded.geometry.getAttribute('position').needsUpdate = true;
    this.bedded.geometry.computeVertexNormals();
  }

  private show(): void {
    const { around, trocar } = this;
    const inBody = around?.inBody ?? false;
    this.group.visible = around !== null;
    this.bedded.visible = inBody;
    this.flesh.visible = inBody && !trocar;
    this.sheath.visible = inBody && trocar;
    this.cloth.visible = !inBody || !trocar;
  }
}
