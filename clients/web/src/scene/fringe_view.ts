// SPDX-License-Identifier: GPL-3.0-or-later
// The torn fibres at the rims of one sheet, or its edge, in three.js: records of the model as they come.
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

import { FRINGE_FLOATS, type FringeShape } from '../model/fringe';
import { FRINGE_VERTEX } from './surface_light';
import { FRAGMENTS } from './tissue_shader';
import type { SharedUniforms } from './tissue_view';

const ATTRIBUTES = [['position', 3, 0], ['material', 3, 3], ['normal', 3, 6], ['burn', 4, 9], ['tip', 1, 13]] as const;
const GROWTH = 1.5; // of the arrays on the card, so that a cut does not make them anew with every face

export class FringeView {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  private records = new Float32Array(0);
  private interleaved: InterleavedBuffer | null = null;
  private index: BufferAttribute | null = null;
  private shown = true;

  constructor(shared: SharedUniforms, kind: 'fringe' | 'edge') {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: FRINGE_VERTEX,
      fragmentShader: FRAGMENTS[kind],
      uniforms: shared,
      side: DoubleSide,
    });
    this.mesh = new Mesh(new BufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
    this.mesh.renderOrder = 2;
  }

  take({ records, index }: FringeShape): void {
    if (records.length > this.records.length || index.length > (this.index?.array.length ?? 0)) this.grow(records.length, index.length);
    this.records.set(records);
    this.index?.array.set(index);
    if (this.interleaved) this.interleaved.needsUpdate = true;
    if (this.index) this.index.needsUpdate = true;
    this.mesh.geometry.setDrawRange(0, index.length);
    this.mesh.visible = this.shown && index.length > 0;
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
    this.records = new Float32Array(FRINGE_FLOATS * Math.ceil((GROWTH * floats) / FRINGE_FLOATS));
    this.interleaved = new InterleavedBuffer(this.records, FRINGE_FLOATS).setUsage(DynamicDrawUsage);
    this.index = new BufferAttribute(new Uint32Array(3 * Math.ceil((GROWTH * indices) / 3)), 1).setUsage(DynamicDrawUsage);
    const geometry = new BufferGeometry();
    for (const [name, size, offset] of ATTRIBUTES)
      geometry.setAttribute(name, new InterleavedBufferAttribute(this.interleaved, size, offset));
    geometry.setIndex(this.index);
    this.mesh.geometry = geometry;
  }
}
