// SPDX-License-Identifier: GPL-3.0-or-later
// Periodic textures, made here once, that tissue's look is read from at different scales, which is cheaper
// in a fragment shader than to compute it there: smooth noise, lobes, and vessels that branch. Their mip-maps
// keep what is finer than the picture from sparkling in it.
import { Data3DTexture, DataTexture, LinearFilter, LinearMipmapNearestFilter, RedFormat, RepeatWrapping, UnsignedByteType, type Texture } from 'three';

import { lobeValues, random, vesselValues } from '../model/patterns';

const SIZE = 48;
const LATTICES = [6, 12, 24]; // cells along each axis, one octave each

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
  return prepared(new Data3DTexture(bytes, SIZE, SIZE, SIZE));
}

function prepared<T extends Texture>(texture: T): T {
  texture.format = RedFormat;
  texture.type = UnsignedByteType;
  texture.minFilter = LinearMipmapNearestFilter;
  texture.magFilter = LinearFilter;
  texture.generateMipmaps = true;
  texture.wrapS = texture.wrapT = RepeatWrapping;
  if (texture instanceof Data3DTexture) texture.wrapR = RepeatWrapping;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

const LOBES_SIZE = 32;
const VESSELS_SIZE = 192;

export function makeLobes(): Data3DTexture {
  return prepared(new Data3DTexture(lobeValues(LOBES_SIZE), LOBES_SIZE, LOBES_SIZE, LOBES_SIZE));
}

export function makeVessels(): DataTexture {
  return prepared(new DataTexture(vesselValues(VESSELS_SIZE), VESSELS_SIZE, VESSELS_SIZE));
}
