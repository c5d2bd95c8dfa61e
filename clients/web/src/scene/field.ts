// SPDX-License-Identifier: GPL-3.0-or-later
// The operative field around the tissue: a bed that it lies on, and flesh around it. In the open view this is a wall up
// to the skin, and a cloth with a window; through a trocar it is tissue of the same kind on and on. Under tissue that
// hangs freely there is a cloth alone.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, FrontSide, GLSL3, Group, Mesh, ShaderMaterial, Vector4, type IUniform, type Side } from 'three';

import { Bed } from '../model/bed';
import { clothAround, clothUnder, fleshAround, sheathAround, ZONES, type FieldShape, type Sheath, type Surroundings } from '../model/field_shape';
import type { Joined } from '../wire/worker_messages';
import { FIELD_FRAGMENTS } from './field_shader';
import { VERTEX } from './surface_light';
import type { SharedUniforms } from './tissue_view';

/** What a sheet that goes on lies over: two colours, and how much of them it covers where it is thin and where it is dense. */
const OVER = {
  fat: [new Vector4(0.70, 0.37, 0.19, 0.52), new Vector4(0.85, 0.60, 0.33, 0.71)],
  muscle: [new Vector4(0.27, 0.040, 0.032, 0.50), new Vector4(0.38, 0.075, 0.058, 0.74)],
};

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

/** In two parts, of which the second is skin alone: rings go outwards, and so do their triangles. */
function skinApart(shape: FieldShape): BufferGeometry {
  const geometry = geometryOf(shape, ZONES.most);
  const { zone, index } = shape;
  const first = zone.findIndex((value) => value >= ZONES.skin); // vertex of the first ring of skin
  const start = index.findIndex((_, i) => i % 3 === 0 && index.subarray(i, i + 3).every((v) => v >= first));
  geometry.addGroup(0, start, 0);
  geometry.addGroup(start, index.length - start, 1);
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
  private readonly bedded: Mesh<BufferGeometry, ShaderMaterial>;
  private readonly bedOf: { readonly muscle: ShaderMaterial; readonly fat: ShaderMaterial };
  private readonly flesh: Mesh<BufferGeometry, ShaderMaterial[]>;
  private readonly sheath: Mesh<BufferGeometry, ShaderMaterial>;
  private readonly below: IUniform<Vector4[]> = { value: [] };
  private readonly sheathOf: Readonly<Record<Sheath['kind'], ShaderMaterial>>;
  private readonly cloth: Mesh<BufferGeometry, ShaderMaterial>;
  private bed: Bed | null = null;
  private around: Surroundings | null = null;
  private trocar = true;

  constructor(shared: SharedUniforms, background: IUniform<Color>) {
    const materialOf = (fragmentShader: string, uniforms: Record<string, IUniform>, side: Side): ShaderMaterial =>
      new ShaderMaterial({ glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader, uniforms, side });
    const make = <M extends ShaderMaterial | ShaderMaterial[]>(material: M): Mesh<BufferGeometry, M> => {
      const mesh = new Mesh(new BufferGeometry(), material);
      mesh.frustumCulled = false;
      this.group.add(mesh);
      return mesh;
    };
    const flesh = materialOf(FIELD_FRAGMENTS.flesh, shared, DoubleSide);
    this.bedOf = { muscle: materialOf(FIELD_FRAGMENTS.muscle, shared, DoubleSide), fat: materialOf(FIELD_FRAGMENTS.bed, shared, DoubleSide) };
    this.bedded = make(this.bedOf.fat);
    this.flesh = make([flesh, materialOf(FIELD_FRAGMENTS.skin, shared, DoubleSide)]);
    // Seen from within the body alone.
    this.sheathOf = {
      fascia: materialOf(FIELD_FRAGMENTS.fasciaSheath, { ...shared, below: this.below }, FrontSide),
      membrane: materialOf(FIELD_FRAGMENTS.membraneSheath, shared, FrontSide),
      fat: materialOf(FIELD_FRAGMENTS.fatSheath, shared, FrontSide),
    };
    this.sheath = make(this.sheathOf.fascia);
    this.cloth = make(materialOf(FIELD_FRAGMENTS.cloth, { ...shared, cloth: this.colour, background }, DoubleSide));
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
    this.bedded.material = around.solid ? this.bedOf.fat : this.bedOf.muscle;
    this.flesh.geometry = skinApart(fleshAround(around));
    this.sheath.geometry = continued(geometryOf(sheathAround(around), 1), around.sheath);
    this.below.value = around.solid ? OVER.fat : OVER.muscle;
    this.sheath.material = this.sheathOf[around.sheath.kind];
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
