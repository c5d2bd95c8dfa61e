// SPDX-License-Identifier: GPL-3.0-or-later
// The tissue in three.js: vertex arrays shared by all batches, one index and one material for each.
import {
  BufferAttribute,
  BufferGeometry,
  ClampToEdgeWrapping,
  DataTexture,
  DoubleSide,
  DynamicDrawUsage,
  GLSL3,
  Group,
  LinearFilter,
  Mesh,
  ShaderMaterial,
  Vector2,
  Vector3,
  Vector4,
  type IUniform,
} from 'three';

import { colourRow, type ColourMap } from '../model/colour_maps';
import { BURN_BYTES, SCALAR } from '../model/tissue';
import { SCALARS } from '../wire/messages.gen';
import type { Frame, Joined } from '../wire/worker_messages';
import { makeLobes, makeNoise, makeVessels } from './noise';
import { VERTEX } from './surface_light';
import { SurfaceView } from './surface_view';
import { FRAGMENTS, type SurfaceKind } from './tissue_shader';

export const CAPSULES_MAX = 8;
/** m: where a capsule shades nothing. */
export const FAR_AWAY = [0, 0, 1000] as const;
export const GLOWS_MAX = 4;

export interface SharedUniforms {
  [name: string]: IUniform;
  noise: IUniform;
  lobes: IUniform;
  vessels: IUniform;
  colourMap: IUniform<DataTexture>;
  mapChannel: IUniform<number>;
  light: IUniform<Vector3>;
  ambient: IUniform<number>;
  scope: IUniform<Vector2>;
  clip: IUniform<Vector4>;
  capsuleCount: IUniform<number>;
  capsuleFrom: IUniform<Vector4[]>;
  capsuleTo: IUniform<Vector3[]>;
  glow: IUniform<Vector4[]>;
  tips: IUniform<Vector4[]>;
}

export function mapTexture(map: ColourMap): DataTexture {
  const texture = new DataTexture(colourRow(map, 256), 256, 1);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.wrapS = texture.wrapT = ClampToEdgeWrapping;
  texture.needsUpdate = true;
  return texture;
}

export function makeSharedUniforms(): SharedUniforms {
  return {
    noise: { value: makeNoise() },
    lobes: { value: makeLobes() },
    vessels: { value: makeVessels() },
    colourMap: { value: mapTexture('cividis') },
    mapChannel: { value: -1 },
    light: { value: new Vector3(0, 0, 1) },
    ambient: { value: 0.42 },
    scope: { value: new Vector2(0, 1) },
    clip: { value: new Vector4(0, 0, 0, 1) }, // nothing
    capsuleCount: { value: 0 },
    capsuleFrom: { value: Array.from({ length: CAPSULES_MAX }, () => new Vector4(...FAR_AWAY, 0)) },
    capsuleTo: { value: Array.from({ length: CAPSULES_MAX }, () => new Vector3(...FAR_AWAY)) },
    glow: { value: Array.from({ length: GLOWS_MAX }, () => new Vector4()) },
    tips: { value: Array.from({ length: GLOWS_MAX }, () => new Vector4()) },
  };
}

/** Programs of sessions without vessels know nothing of blood, so it costs them nothing. BLOOD_M: depth of the fourth
 * byte's 255, m. */
function definesOf({ blood }: Joined): Record<string, string> {
  return blood ? { BLOOD_M: (SCALARS.blood.most * SCALARS.blood.step).toFixed(6) } : {};
}

function makeMaterial(kind: SurfaceKind, shared: SharedUniforms, defines: Record<string, string>): ShaderMaterial {
  const material = new ShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENTS[kind],
    uniforms: shared,
    defines,
    side: DoubleSide,
    transparent: kind === 'fascia',
  });
  return material;
}

export class TissueView {
  readonly group = new Group();
  readonly indices: (Uint32Array | null)[];
  readonly position: BufferAttribute;
  readonly normal: BufferAttribute;
  private readonly burn: BufferAttribute;
  private readonly meshes: Mesh<BufferGeometry, ShaderMaterial>[];
  /** of each batch: the surface that cuts lay bare, its lips, and what frays from them */
  private readonly lips: (Record<'band' | 'wall' | 'fringe', SurfaceView> | null)[];
  private readonly edges: (SurfaceView | null)[];

  constructor(
    readonly joined: Joined,
    shared: SharedUniforms,
  ) {
    const count = joined.stream.vertex_count;
    this.position = new BufferAttribute(new Float32Array(3 * count), 3).setUsage(DynamicDrawUsage);
    this.normal = new BufferAttribute(new Float32Array(3 * count), 3).setUsage(DynamicDrawUsage);
    this.burn = new BufferAttribute(new Uint8Array(BURN_BYTES * count), BURN_BYTES, true).setUsage(DynamicDrawUsage);
    const material = new BufferAttribute(joined.material, 3);
    const defines = definesOf(joined);
    this.indices = joined.batches.map(() => null);
    this.meshes = joined.batches.map((batch) => {
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', this.position);
      geometry.setAttribute('normal', this.normal);
      geometry.setAttribute('burn', this.burn);
      geometry.setAttribute('material', material);
      geometry.setIndex(new BufferAttribute(new Uint32Array(0), 1));
      const kind = surfaceKind(batch);
      const mesh = new Mesh(geometry, makeMaterial(kind, shared, defines));
      mesh.frustumCulled = false;
      mesh.renderOrder = kind === 'fascia' ? 2 : 1;
      this.group.add(mesh);
      return mesh;
    });
    const sheet = ({ kind }: Joined['batches'][number]): boolean => kind === 'fascia' || kind === 'membrane';
    this.lips = joined.batches.map((batch) => {
      if (!sheet(batch) && !batch.bared) return null;
      return { band: new SurfaceView(shared, surfaceKind(batch), defines), wall: new SurfaceView(shared, 'edge', defines), fringe: new SurfaceView(shared, 'fringe', defines) };
    });
    this.edges = joined.batches.map((batch) => (sheet(batch) ? new SurfaceView(shared, 'edge', defines) : null));
    joined.batches.forEach((_batch, b) => {
      for (const view of this.beside(b)) this.group.add(view.mesh);
    });
  }

  /** Applies a frame. Returns the arrays that were drawn before. */
  take(frame: Frame): Frame['buffers'] {
    const before = {
      position: this.position.array as Float32Array,
      normal: this.normal.array as Float32Array,
      burn: this.burn.array as Uint8Array,
    };
    this.position.array = frame.buffers.position;
    this.normal.array = frame.buffers.normal;
    this.burn.array = frame.buffers.burn;
    for (const attribute of [this.position, this.normal, this.burn]) attribute.needsUpdate = true;
    for (const { batch, index, plain } of frame.drawn) this.setIndex(batch, index, plain);
    for (const { batch, ...shape } of frame.lips)
      for (const part of ['band', 'wall', 'fringe'] as const) this.lips[batch]?.[part].take(shape[part]);
    for (const { batch, ...shape } of frame.edges) this.edges[batch]?.take(shape);
    return before;
  }

  /** bordered: sheets have walls at their borders. Those that go on beyond them have none, since they shine through. */
  showLayer(layer: string, visible: boolean, bordered: boolean): void {
    this.joined.batches.forEach((batch, b) => {
      if (batch.layer !== layer) return;
      this.meshes[b].visible = visible;
      for (const view of this.beside(b)) view.show(visible && (bordered || view !== this.edges[b]));
    });
  }

  setWireframe(wireframe: boolean): void {
    this.meshes.forEach((mesh, b) => {
      mesh.material.wireframe = wireframe;
      for (const view of this.beside(b)) view.setWireframe(wireframe);
    });
  }

  /** Returns the indices of visible faces, for picking. */
  visibleIndices(): (Uint32Array | null)[] {
    return this.indices.map((index, b) => (this.meshes[b].visible ? index : null));
  }

  /** Returns whether a drawn face of a layer lies above or below a point of the plane z = 0. */
  covers(layer: string, x: number, y: number): boolean {
    const at = this.position.array as Float32Array;
    return this.joined.batches.some((batch, b) => {
      const index = this.indices[b];
      if (batch.layer !== layer || batch.bared || !index) return false;
      for (let i = 0; i < index.length; i += 3) if (insideOf(at, index, i, x, y)) return true;
      return false;
    });
  }

  /** Returns the shown scalar over its range, 0 to 1, at the vertex nearest to a point. */
  scalarAt(point: readonly [number, number, number]): number {
    const at = this.position.array as Float32Array;
    let nearest = 0;
    let least = Infinity;
    for (let v = 0; 3 * v < at.length; v++) {
      const away = Math.hypot(at[3 * v] - point[0], at[3 * v + 1] - point[1], at[3 * v + 2] - point[2]);
      if (away >= least) continue;
      least = away;
      nearest = v;
    }
    return this.burn.array[BURN_BYTES * nearest + SCALAR] / 255;
  }

  /** Returns the position and shown scalar, 0 to 255, of each vertex. */
  scalars(): { at: number[]; byte: number }[] {
    const { array } = this.position;
    return Array.from({ length: array.length / 3 }, (_, v) => ({ at: [...array.slice(3 * v, 3 * v + 3)], byte: this.burn.array[BURN_BYTES * v + SCALAR] }));
  }

  dispose(): void {
    this.meshes.forEach((mesh, b) => {
      mesh.geometry.dispose();
      mesh.material.dispose();
      for (const view of this.beside(b)) view.dispose();
    });
  }

  /** Returns the surfaces that are drawn for a batch besides its faces. */
  private beside(batch: number): SurfaceView[] {
    const lips = this.lips[batch];
    const edge = this.edges[batch];
    return [...(lips ? [lips.band, lips.wall, lips.fringe] : []), ...(edge ? [edge] : [])];
  }

  /** Sets the indices of a batch. `plain` is the number of faces that are drawn unrefined. */
  private setIndex(batch: number, index: Uint32Array, plain: number): void {
    this.indices[batch] = index;
    const { geometry } = this.meshes[batch];
    const attribute = geometry.getIndex()!;
    // The index of a batch usually shrinks. The buffer on the card is kept, and only its first part is drawn.
    if (index.length > attribute.array.length) {
      geometry.setIndex(new BufferAttribute(index.slice(), 1).setUsage(DynamicDrawUsage));
    } else {
      attribute.array.set(index);
      attribute.needsUpdate = true;
    }
    geometry.setDrawRange(0, 3 * plain);
  }
}

function surfaceKind(batch: Joined['batches'][number]): SurfaceKind {
  return batch.bared ? 'bared' : batch.kind === 'links' ? 'membrane' : batch.kind;
}

/** Returns whether a point is inside a triangle, seen along z. */
function insideOf(at: Float32Array, index: Uint32Array, first: number, x: number, y: number): boolean {
  let turns = 0;
  for (let c = 0; c < 3; c++) {
    const a = 3 * index[first + c];
    const b = 3 * index[first + ((c + 1) % 3)];
    turns += Math.sign((at[b] - at[a]) * (y - at[a + 1]) - (at[b + 1] - at[a + 1]) * (x - at[a]));
  }
  return Math.abs(turns) === 3;
}
