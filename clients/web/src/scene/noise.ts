// SPDX-License-Identifier: GPL-3.0-or-later
// A periodic volume of smooth noise, made here once: fibres, lobes and blotches of tissue are read from
// it at different scales, which is cheaper in a fragment shader than to compute noise there.
import { Data3DTexture, LinearFilter, RedFormat, RepeatWrapping, UnsignedByteType } from 'three';

const SIZE = 48;
const LATTICES = [6, 12, 24]; // cells along each axis, one octave each

function random(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) | 0;
    return (state >>> 0) / 2 ** 32;
  };
}

const smooth = (t: number): number => t * t * t * (t * (6 * t - 15) + 10);
const mix = (a: number, b: number, t: number): number => a + (b - a) * t;

function octave(cells: number, values: Float32Array, out: Float32Array, weight: number): void {
  const at = (x: number, y: number, z: number): number => values[(z % cells) * cells * cells + (y % cells) * cells + (x % cells)];
  for (let z = 0, i = 0; z < SIZE; z++) {
    const gz = (z * cells) / SIZE, z0 = Math.floor(gz), fz = smooth(gz - z0);
    for (let y = 0; y < SIZE; y++) {
      const gy = (y * cells) / SIZE, y0 = Math.floor(gy), fy = smooth(gy - y0);
      for (let x = 0; x < SIZE; x++, i++) {
        const gx = (x * cells) / SIZE, x0 = Math.floor(gx), fx = smooth(gx - x0);
        const low = mix(mix(at(x0, y0, z0), at(x0 + 1, y0, z0), fx), mix(at(x0, y0 + 1, z0), at(x0 + 1, y0 + 1, z0), fx), fy);
        const high = mix(
          mix(at(x0, y0, z0 + 1), at(x0 + 1, y0, z0 + 1), fx),
          mix(at(x0, y0 + 1, z0 + 1), at(x0 + 1, y0 + 1, z0 + 1), fx),
          fy,
        );
        out[i] += weight * mix(low, high, fz);
      }
    }
  }
}

/** Values from 0 to 1 around one half; one period is one unit of texture coordinates. */
export function makeNoise(): Data3DTexture {
  const sum = new Float32Array(SIZE ** 3);
  const next = random(7);
  let weight = 0.55;
  for (const cells of LATTICES) {
    octave(cells, Float32Array.from({ length: cells ** 3 }, next), sum, weight);
    weight *= 0.5;
  }
  const bytes = Uint8Array.from(sum, (value) => Math.round((255 * value) / 0.9625));
  const texture = new Data3DTexture(bytes, SIZE, SIZE, SIZE);
  texture.format = RedFormat;
  texture.type = UnsignedByteType;
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.wrapS = texture.wrapT = texture.wrapR = RepeatWrapping;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}
