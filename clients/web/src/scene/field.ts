// SPDX-License-Identifier: GPL-3.0-or-later
// The operative field around the tissue: flesh that it lies in and a cloth with a window; under tissue that
// hangs freely, the cloth alone.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, GLSL3, Group, Mesh, ShaderMaterial, type IUniform } from 'three';

import { clothAround, clothUnder, fleshAround, ZONES, type FieldShape, type Surroundings } from '../model/field_shape';
import { VERTEX } from './surface_light';
import { FRAGMENTS } from './tissue_shader';
import type { SharedUniforms } from './tissue_view';

function geometryOf({ position, zone, index }: FieldShape, mostZone: number): BufferGeometry {
  const geometry = new BufferGeometry();
  const burn = new Float32Array(4 * zone.length); // unburnt
  zone.forEach((value, i) => (burn[4 * i + 3] = value / mostZone));
  geometry.setAttribute('position', new BufferAttribute(position, 3));
  geometry.setAttribute('material', new BufferAttribute(position, 3));
  geometry.setAttribute('burn', new BufferAttribute(burn, 4));
  geometry.setIndex(new BufferAttribute(index, 1));
  geometry.computeVertexNormals();
  return geometry;
}

export class Field {
  readonly group = new Group();
  private readonly colour: IUniform<Color> = { value: new Color() };
  private readonly flesh: Mesh<BufferGeometry, ShaderMaterial>;
  private readonly cloth: Mesh<BufferGeometry, ShaderMaterial>;

  constructor(shared: SharedUniforms, background: IUniform<Color>) {
    const make = (fragmentShader: string, uniforms: Record<string, IUniform>): Mesh<BufferGeometry, ShaderMaterial> => {
      const material = new ShaderMaterial({ glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader, uniforms, side: DoubleSide });
      const mesh = new Mesh(new BufferGeometry(), material);
      mesh.frustumCulled = false;
      this.group.add(mesh);
      return mesh;
    };
    this.flesh = make(FRAGMENTS.flesh, shared);
    this.cloth = make(FRAGMENTS.cloth, { ...shared, cloth: this.colour, background });
    // After what lies over them, so that what is hidden is not shaded: much of the flesh is under the cloth.
    this.cloth.renderOrder = 2;
    this.flesh.renderOrder = 3;
    this.group.visible = false;
  }

  setTheme(dark: boolean): void {
    if (dark) this.colour.value.setRGB(0.028, 0.15, 0.165);
    else this.colour.value.setRGB(0.075, 0.30, 0.33);
  }

  /** null: there is no tissue */
  place(around: Surroundings | null): void {
    this.group.visible = around !== null;
    if (!around) return;
    this.flesh.visible = around.inBody;
    for (const mesh of [this.flesh, this.cloth]) mesh.geometry.dispose();
    if (around.inBody) this.flesh.geometry = geometryOf(fleshAround(around), ZONES.most);
    this.cloth.geometry = geometryOf(around.inBody ? clothAround(around) : clothUnder(around), 1);
  }
}
