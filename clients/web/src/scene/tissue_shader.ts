// SPDX-License-Identifier: GPL-3.0-or-later
// How tissue looks: a fragment shader for each kind. Lengths in metres, colours linear.
import { COMMON } from './surface_light';

// A pearly sheet of collagen: pale bundles that wander, thinner and glassier between them, where what
// lies below shows through, with vessels in it.
export const FASCIA_LOOK = /* glsl */ `
float bundled(vec3 along) { return n(vec3(16.0 * along.x + 41.0 * along.y, 170.0 * along.yz)); }
float weave(vec3 along, out float bundle, out float strand) {
  bundle = bundled(along);
  strand = n(vec3(34.0 * along.x + 97.0 * along.y, 560.0 * along.yz) + 0.37);
  return 0.6 * bundle + 0.4 * strand;
}
// Unevenness of the sheet. The noise's lattice is turned against the sheet and against its axes: noise along them mirrors
// in squares from close by.
const mat3 TURNED = mat3(0.799, 0.516, 0.310, -0.554, 0.429, 0.714, 0.235, -0.742, 0.628); // 23 deg about x, 37 about z, 31 about x
float uneven(vec3 m) { return n(34.0 * TURNED * m); }
Surface fascia(vec3 normal, vec3 view, vec3 m, out float fibre, out float blotch) {
  float wander = n(m * 11.0);
  vec3 along = m + vec3(0.0, 0.0035 * (wander - 0.5), 0.0);
  float bundle, strand, unused;
  float here = weave(along, bundle, strand);
  Steps over = steps(0.0002);
  vec2 rise = vec2(weave(along + over.x, unused, unused), weave(along + over.y, unused, unused)) - here;
  // It is uneven by some tenths of a millimetre, which breaks what it mirrors into wet patches.
  blotch = uneven(m);
  // A difference over more than a texel of the noise: over less it has a step at each, which mirrors as squares.
  Steps wide = steps(0.0009);
  vec2 slope = (vec2(uneven(m + wide.x), uneven(m + wide.y)) - blotch) * over.longer / wide.longer;
  fibre = 0.5 * bundle + 0.5 * strand;
  float dense = smoothstep(0.34, 0.66, 0.84 * here + 0.16 * blotch);
  Surface s;
  s.normal = bend(normal, over, 0.00006 * rise + 0.0010 * slope, 1.0);
  s.colour = mix(vec3(0.67, 0.38, 0.31), vec3(0.76, 0.53, 0.45), dense);
  s.colour = mix(s.colour, vec3(0.66, 0.33, 0.27), 0.4 * smoothstep(0.42, 0.70, blotch));
  float blood = vessel(m.xy + 0.0016 * (vec2(wander, blotch) - 0.5));
  s.colour = mix(s.colour, vec3(0.36, 0.035, 0.045), 0.72 * blood);
  float grazing = 1.0 - abs(dot(normal, view));
  s.alpha = clamp(mix(0.50, 0.74, dense) + 0.25 * blood + 0.5 * grazing * grazing, 0.0, 1.0);
  s.gloss = 60.0;
  s.wet = mix(0.26, 0.66, smoothstep(0.40, 0.62, blotch)); // the film lies in patches
  return s;
}
const vec3 CREAM = vec3(0.78, 0.66, 0.51);
const vec3 TAN = vec3(0.40, 0.235, 0.115);
`;

const FASCIA = /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  float fibre, blotch;
  Surface s = fascia(normal, view, vMaterial, fibre, blotch);
  burnt(s, CREAM, TAN, 0.6 * fibre + 0.4 * blotch);
  finish(s, view);
}`;

// Torn fibres beyond a rim: fewer the further out, each ending in a point, browned from the tip.
const FRINGE = /* glsl */ `
in float vTip;
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  vec3 wave = vMaterial + 0.0005 * vTip * (vec3(n(vMaterial * 90.0), n(vMaterial * 90.0 + 0.4), 0.5) - 0.5);
  // Threads are long along the fibre and a tenth of a millimetre wide.
  float coarse = n(vec3(60.0, 420.0, 420.0) * wave + 0.71);
  float fine = n(vec3(90.0, 1100.0, 1100.0) * wave + 0.13);
  float thread = 0.62 * coarse + 0.38 * fine;
  if (thread < 0.47 + 0.16 * vTip) discard;
  float fibre, blotch;
  Surface s = fascia(normal, view, wave, fibre, blotch);
  s.colour *= 0.75 + 0.5 * fine;
  s.alpha = 1.0;
  s.wet = 0.1;
  burnt(s, CREAM, TAN, 0.35 + 0.3 * vTip + 0.35 * fine);
  finish(s, view);
}`;

// The edge of a sheet: ends of bundles at a cut, its side elsewhere, darker towards what it lies on.
const EDGE = /* glsl */ `
in float vTip;
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  float fibre, blotch;
  Surface s = fascia(normal, view, vMaterial, fibre, blotch);
  s.colour *= mix(1.15, 0.55, vTip) * (0.80 + 0.4 * fibre);
  s.alpha = 1.0;
  burnt(s, CREAM, TAN, 0.6 * fibre + 0.4 * blotch);
  finish(s, view);
}`;

// Lobes of fat, domed, with septa between them.
export const FAT_LOOK = /* glsl */ `
const vec3 STRAW = vec3(0.80, 0.57, 0.25);
float domes(vec3 m) { return lobed(m * 33.0) + 0.22 * lobed(m * 91.0); }
Surface fat(vec3 normal, vec3 m, float bulge, out float grain) {
  float warp = n(m * 27.0);
  vec3 bent = m + 0.0024 * (warp - 0.5) * vec3(1.0, -0.8, 0.6);
  float here = domes(bent);
  Steps over = steps(0.0004);
  vec2 rise = vec2(domes(bent + over.x), domes(bent + over.y)) - here;
  grain = n(m * 120.0);
  Surface s;
  s.normal = bend(normal, over, rise, bulge);
  float dome = smoothstep(0.15, 0.75, here);
  s.colour = mix(vec3(0.60, 0.27, 0.09), vec3(0.88, 0.62, 0.22), dome);
  s.colour = mix(s.colour, vec3(0.93, 0.72, 0.36), 0.4 * smoothstep(0.7, 1.1, here));
  s.colour *= 0.93 + 0.14 * grain;
  s.alpha = 1.0;
  s.gloss = 50.0;
  s.wet = mix(0.06, 0.45, smoothstep(0.42, 0.64, warp)); // the film lies in patches
  return s;
}
`;

export const MEMBRANE_LOOK = /* glsl */ `
Surface membrane(vec3 normal, vec3 m, out float film) {
  Surface s = fat(normal, m, 0.0008, film);
  s.colour = mix(s.colour, vec3(0.74, 0.38, 0.31), 0.30);
  s.colour = mix(s.colour, vec3(0.34, 0.03, 0.035), 0.7 * vessel(m.yx + vec2(0.031, 0.012)));
  s.gloss = 60.0;
  s.wet *= 1.2;
  return s;
}
`;

const MEMBRANE = /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  float film;
  Surface s = membrane(normal, vMaterial, film);
  // Heat shrivels the film: it is rough and mottled there, by some hundredths of a millimetre.
  float fine = n(vMaterial * 430.0);
  float heated = smoothstep(0.08, 0.40, vBurn.x);
  s.normal = bend(s.normal, steps(0.0), vec2(dFdx(fine), dFdy(fine)), 0.00010 * heated);
  s.colour *= 1.0 + 0.5 * heated * (fine - 0.5);
  burnt(s, vec3(0.68, 0.48, 0.28), vec3(0.46, 0.185, 0.07), 0.35 * film + 0.35 * n(vMaterial * 70.0) + 0.3 * fine);
  finish(s, view);
}`;

const FAT = /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  float grain;
  Surface s = fat(normal, vMaterial, 0.0015, grain);
  burnt(s, STRAW, vec3(0.54, 0.235, 0.065), 0.5 * grain + 0.5 * n(vMaterial * 60.0 + 0.5));
  finish(s, view);
}`;

// The inside of fat, laid open: small lobules, moist, browned from the septa between them, with a little blood. It lies
// in a hollow, where less light comes from all around.
const BARED = /* glsl */ `
float lobules(vec3 m) { return lobed(m * 52.0) + 0.30 * lobed(m * 117.0); }
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  vec3 bent = vMaterial + 0.0016 * (n(vMaterial * 41.0) - 0.5) * vec3(1.0, -0.8, 0.6);
  float here = lobules(bent);
  Steps over = steps(0.0003);
  vec2 rise = vec2(lobules(bent + over.x), lobules(bent + over.y)) - here;
  float dome = smoothstep(0.10, 0.80, here);
  float patchy = smoothstep(0.30, 0.70, n(vMaterial * 60.0 + 0.5));
  Surface s;
  s.normal = bend(normal, over, rise, 0.0017);
  s.colour = mix(vec3(0.62, 0.30, 0.10), vec3(0.90, 0.65, 0.26), dome) * (0.92 + 0.16 * n(vMaterial * 120.0));
  s.alpha = 1.0;
  s.gloss = 50.0;
  s.wet = 0.3;
  burnt(s, STRAW, vec3(0.47, 0.24, 0.075), 0.55 * (1.0 - dome) + 0.45 * patchy);
  float blood = smoothstep(0.54, 0.68, n(vMaterial * 24.0 + 0.23)) * (1.0 - 0.6 * dome);
  s.colour = mix(s.colour, vec3(0.33, 0.045, 0.03), 0.45 * blood);
  s.colour *= vec3(0.56, 0.50, 0.44) + vec3(0.38, 0.44, 0.48) * dome;
  finish(s, view);
}`;

export const FRAGMENTS = {
  fascia: COMMON + FASCIA_LOOK + FASCIA,
  fringe: COMMON + FASCIA_LOOK + FRINGE,
  edge: COMMON + FASCIA_LOOK + EDGE,
  membrane: COMMON + FAT_LOOK + MEMBRANE_LOOK + MEMBRANE,
  fat: COMMON + FAT_LOOK + FAT,
  bared: COMMON + FAT_LOOK + BARED,
} as const;
export type SurfaceKind = keyof typeof FRAGMENTS;
