// SPDX-License-Identifier: GPL-3.0-or-later
// How what lies around the tissue looks: a fragment shader for each kind. Lengths in metres, colours linear.
import { COMMON } from './surface_light';
import { FASCIA_LOOK, FAT_LOOK, MEMBRANE_LOOK } from './tissue_shader';

// Around the tissue, drawn only: muscle under it, walls of fat in its membrane, the cut edge of the skin. It fills
// much of the picture and is looked past: fat of one size of lobes, few readings of textures, and skin, which
// most of it is, with one alone, keep the picture from taking much longer than without it. Where there is nothing but skin
// a shader of its own draws it: software computes both sides of an `if`.
const SKIN_LOOK = /* glsl */ `
vec3 skinned(float film) { return vec3(0.62, 0.33, 0.205) * (0.92 + 0.16 * film); }
`;
const SKIN = /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  Surface s;
  s.normal = normalize(vNormal);
  if (dot(s.normal, view) < 0.0) s.normal = -s.normal;
  s.colour = skinned(n(vMaterial * 120.0));
  s.alpha = 1.0;
  s.gloss = 60.0;
  s.wet = 0.10;
  show(s, view);
}`;
// The bed is seen through the sheet over it. So it has two or three readings of textures instead of seven: muscle alone
// under a sheet, fat without fine slopes around solid tissue.
const BED_LOOK = /* glsl */ `
float blotched(vec3 m) { return n(m * 15.0 + 0.3); }
vec3 warped(vec3 m, float blotch) { return 33.0 * (m + 0.0024 * (blotch - 0.5) * vec3(1.0, -0.8, 0.6)); }
vec3 fatty(vec3 m, float lobe, float film, float blotch) {
  vec3 colour = mix(vec3(0.60, 0.27, 0.09), vec3(0.88, 0.62, 0.22), smoothstep(0.05, 0.65, lobe));
  colour = mix(colour, vec3(0.93, 0.72, 0.36), 0.4 * smoothstep(0.6, 1.0, lobe));
  colour = mix(colour * (0.93 + 0.14 * film), vec3(0.74, 0.38, 0.31), 0.30);
  colour = mix(colour, vec3(0.34, 0.03, 0.035), 0.7 * vessel(m.yx + vec2(0.031, 0.012)));
  return mix(colour, vec3(0.62, 0.20, 0.13), 0.45 * smoothstep(0.45, 0.65, blotch));
}
vec3 muscular(vec3 m, float blotch) {
  float stripe = n(vec3(28.0 * m.x, 260.0 * m.y + 70.0 * blotch, 40.0 * m.z));
  return mix(vec3(0.27, 0.040, 0.032), vec3(0.38, 0.075, 0.058), smoothstep(0.3, 0.7, stripe));
}
`;
const MUSCLE = /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  Surface s;
  s.normal = normalize(vNormal);
  if (dot(s.normal, view) < 0.0) s.normal = -s.normal;
  s.colour = muscular(vMaterial, blotched(vMaterial));
  s.alpha = 1.0;
  s.gloss = 60.0;
  s.wet = 0.03;
  show(s, view);
}`;
const BED = /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  float blotch = blotched(vMaterial);
  float lobe = lobed(warped(vMaterial, blotch));
  float zone = 3.0 * vBurn.w;
  float fat = smoothstep(0.55, 0.95, zone); // else the floor of the well, which solid tissue hides
  Surface s;
  s.normal = bend(normal, steps(0.0), vec2(dFdx(lobe), dFdy(lobe)), 0.0009 * fat);
  s.colour = mix(vec3(0.32, 0.055, 0.045), fatty(vMaterial, lobe, 0.5, blotch), fat);
  s.alpha = 1.0;
  s.gloss = 60.0;
  s.wet = mix(0.03, 0.5, fat);
  show(s, view);
}`;
const FLESH = /* glsl */ `
vec3 inside(vec3 m, float zone, float film, Steps over, out vec2 rise) {
  float blotch = blotched(m);
  vec3 bent = warped(m, blotch);
  float lobe = lobed(bent);
  rise = vec2(lobed(bent + 33.0 * over.x), lobed(bent + 33.0 * over.y)) - lobe;
  vec3 colour = mix(muscular(m, blotch), fatty(m, lobe, film, blotch), smoothstep(0.55, 0.95, zone));
  return mix(colour, vec3(0.82, 0.62, 0.52), smoothstep(1.2, 1.5, zone + 0.3 * (film - 0.5)));
}
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  vec3 m = vMaterial;
  float zone = 3.0 * vBurn.w;
  Steps over = steps(0.0004);
  float film = n(m * 120.0);
  float skin = smoothstep(1.75, 1.95, zone + 0.1 * (film - 0.5));
  vec2 rise;
  Surface s;
  s.colour = mix(inside(m, zone, film, over, rise), skinned(film), skin);
  float fat = smoothstep(0.55, 0.95, zone); // muscle has no lobes, and is dull
  s.normal = bend(normal, over, rise, 0.0009 * fat * (1.0 - skin));
  s.alpha = 1.0;
  s.gloss = 60.0;
  s.wet = mix(mix(0.03, 0.5, fat), 0.10, skin);
  show(s, view);
}`;

// What continues the tissue in the body: the same sheet over lobed fat or muscle, or fat with a membrane or without. It is looked past:
// bundles of fibres are colour without slopes and without strands in them, which would cost as much again. Readings of
// volumes are most of its cost, so the sheet wanders by sines, and its slopes are differences between pixels.
const SHEATH_LOOK = /* glsl */ `
uniform vec4 below[2]; // what shines through, two colours of it, and how much of them the sheet covers where it is thin and dense
// Between texels of the noise a cubic instead of a line: slopes of lines have a step at each, which mirrors as squares.
vec3 between(vec3 p) {
  vec3 at = 48.0 * p - 0.5, whole = floor(at), part = at - whole;
  return (whole + part * part * (3.0 - 2.0 * part) + 0.5) / 48.0;
}
Surface afar(vec3 normal, vec3 m) {
  float blotch = n(between(m * 34.0));
  float wander = 0.5 + 0.5 * sin(41.0 * m.x + 23.0 * m.y + 4.0 * blotch);
  vec3 along = m + vec3(0.0, 0.0012 * (wander - 0.5), 0.0);
  float dense = smoothstep(0.26, 0.74, bundled(along));
  vec3 under = mix(below[0].rgb, below[1].rgb, smoothstep(0.30, 0.62, wander));
  Surface s;
  s.normal = bend(normal, steps(0.0), vec2(dFdx(blotch), dFdy(blotch)), 0.0007);
  s.colour = mix(vec3(0.67, 0.38, 0.31), vec3(0.76, 0.53, 0.45), dense);
  s.colour = mix(s.colour, vec3(0.66, 0.33, 0.27), 0.4 * smoothstep(0.42, 0.70, blotch));
  float blood = vessel(m.xy + 0.0016 * (vec2(wander, blotch) - 0.5));
  s.colour = mix(s.colour, vec3(0.36, 0.035, 0.045), 0.72 * blood);
  // As the blending of the tissue's own sheet does: between roots, which is how the picture holds its colours.
  vec3 root = mix(sqrt(under), sqrt(s.colour), mix(below[0].a, below[1].a, dense));
  s.colour = root * root;
  s.gloss = 60.0;
  s.wet = mix(0.26, 0.66, smoothstep(0.40, 0.62, blotch));
  s.alpha = 1.0;
  return s;
}
`;
// Which of them it is, is known when the shader is made: in software both sides of an `if` are computed.
const sheath = (look: string): string => /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  float grain;
  show(${look}, view);
}`;

const CLOTH = /* glsl */ `
uniform vec3 cloth;
uniform vec3 background;
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  Surface s;
  s.normal = normal;
  s.colour = cloth * (0.9 + 0.2 * n(vec3(vWorld.xy * 45.0, 0.2)));
  s.alpha = 1.0;
  s.gloss = 20.0;
  s.wet = 0.03;
  show(s, view);
  fragment.rgb = mix(fragment.rgb, background, smoothstep(0.5, 1.0, vBurn.w));
}`;

export const FIELD_FRAGMENTS = {
  muscle: COMMON + BED_LOOK + MUSCLE,
  bed: COMMON + BED_LOOK + BED,
  flesh: COMMON + SKIN_LOOK + BED_LOOK + FLESH,
  skin: COMMON + SKIN_LOOK + SKIN,
  fasciaSheath: COMMON + FASCIA_LOOK + SHEATH_LOOK + sheath(/* glsl */ 'afar(normal, vMaterial)'),
  membraneSheath: COMMON + FAT_LOOK + MEMBRANE_LOOK + sheath(/* glsl */ 'membrane(normal, vMaterial, grain)'),
  fatSheath: COMMON + FAT_LOOK + sheath(/* glsl */ 'fat(normal, vMaterial, 0.0015, grain)'),
  cloth: COMMON + CLOTH,
} as const;
