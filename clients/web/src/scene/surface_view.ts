// SPDX-License-Identifier: GPL-3.0-or-later
// A surface in three.js that is drawn besides the faces of the mesh: lips of a layer, their edge, frayed fibres, or the
// border of a sheet. It draws the records of the model.
import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  DynamicDrawUsage,
  GLSL3,
  InterleavedBuffer,
  InterleavedBufferAttribute,
  Mesh,
  ShaderMaterial,
} from 'three';

import { SURFACE_FLOATS, type SurfaceShape } from '../model/surface';
import { SURFACE_VERTEX } from './surface_light';
import { FRAGMENTS, type SurfaceKind } from './tissue_shader';
import type { SharedUniforms } from './tissue_view';

const ATTRIBUTES = [['position', 3, 0], ['material', 3, 3], ['normal', 3, 6], ['burn', 4, 9], ['tip', 1, 13]] as const;
const GROWTH = 1.5; // growth of the arrays on the card, so that a cut does not create new arrays with every face

export class SurfaceView {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  private records = new Float32Array(0);
  private interleaved: InterleavedBuffer | null = null;
  private index: BufferAttribute | null = null;
  private shown = true;

  constructor(shared: SharedUniforms, kind: SurfaceKind, defines: Record<string, string>) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: SURFACE_VERTEX,
      fragmentShader: FRAGMENTS[kind],
      uniforms: shared,
      defines,
      side: DoubleSide,
      transparent: kind === 'fascia',
    });
    this.mesh = new Mesh(new BufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
    this.mesh.renderOrder = kind === 'membrane' || kind === 'bared' ? 1 : 2;
  }

  take({ records, index }: SurfaceShape): void {
    const indices = index?.length ?? 0;
    if (records.length > this.records.length || indices > (this.index?.array.length ?? 0)) this.grow(records.length, indices);
    this.records.set(records);
    if (this.interleaved) this.interleaved.needsUpdate = true;
    if (!index) return;
    this.index?.array.set(index);
    if (this.index) this.index.needsUpdate = true;
    this.mesh.geometry.setDrawRange(0, indices);
    this.mesh.visible = this.shown && indices > 0;
  }

  show(shown: boolean): void {
    this.shown = shown;
    this.mesh.visible = shown && this.mesh.geometry.drawRange.count > 0 && this.index !== null;
  }

  setWireframe(wireframe: boolean): void {
    this.mesh.material.wireframe = wireframe;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }

  private grow(floats: number, indices: number): void {
    this.mesh.geometry.dispose();
    this.records = new Float32Array(SURFACE_FLOATS * Math.ceil((GROWTH * floats) / SURFACE_FLOATS));
    this.interleaved = new InterleavedBuffer(this.records, SURFACE_FLOATS).setUsage(DynamicDrawUsage);
    this.index = new BufferAttribute(new Uint32Array(3 * Math.ceil((GROWTH * indices) / 3)), 1).setUsage(DynamicDrawUsage);
    const geometry = new BufferGeometry();
    for (const [name, size, offset] of ATTRIBUTES)
      geometry.setAttribute(name, new InterleavedBufferAttribute(this.interleaved, size, offset));
    geometry.setIndex(this.index);
    this.mesh.geometry = geometry;
  }
}
