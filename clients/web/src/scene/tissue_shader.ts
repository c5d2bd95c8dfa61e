// SPDX-License-Identifier: GPL-3.0-or-later
// How tissue looks: one vertex shader, and fragment shaders made of shared light and burn with a
// surface for each kind of tissue. Lengths in metres, colours linear.

export const VERTEX = /* glsl */ `
in vec4 burn;
in vec3 material;
out vec3 vWorld;
out vec3 vNormal;
out vec4 vBurn;
out vec3 vMaterial;
void main() {
  vWorld = position;
  vNormal = normal;
  vBurn = burn;
  vMaterial = material;
  gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
}`;

export const FRINGE_VERTEX = /* glsl */ `
in vec3 material;
in vec3 heat;
in float tip;
out vec3 vWorld;
out vec3 vNormal;
out vec4 vBurn;
out vec3 vMaterial;
out float vTip;
void main() {
  vWorld = position;
  vNormal = normal;
  vBurn = vec4(heat.xy, 1.0, heat.z);
  vMaterial = material;
  vTip = tip;
  gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
}`;

const COMMON = /* glsl */ `
precision highp float;
precision highp sampler3D;
in vec3 vWorld;
in vec3 vNormal;
in vec4 vBurn;
in vec3 vMaterial;
out vec4 fragment;
uniform sampler3D noise;
uniform sampler2D colourMap;
uniform int mapChannel;   // -1: as tissue; else the channel of burn shown as colour
uniform vec3 light;       // the lamp, world
uniform float ambient;
uniform int capsuleCount;
uniform vec4 capsuleFrom[8]; // xyz and radius: parts of instruments that cast shadow
uniform vec3 capsuleTo[8];
uniform vec4 glow[4];     // xyz of hot tips and how much they glow

float n(vec3 p) { return texture(noise, p).r; }

// Share of the sky that a capsule leaves (after Quilez), and of the lamp.
float openness(vec3 p, vec3 normal, vec3 a, vec3 b, float r) {
  vec3 ba = b - a, pa = p - a;
  float h = clamp(dot(pa, ba) / max(dot(ba, ba), 1e-12), 0.0, 1.0);
  vec3 d = pa - h * ba;
  float l = max(length(d), r * 0.6);
  return 1.0 - clamp(max(0.0, dot(-d, normal)) * r * r / (l * l * l), 0.0, 1.0) * 0.85;
}
float lit(vec3 p, vec3 toLight, vec3 a, vec3 b, float r) {
  vec3 ba = b - a, oa = p - a;
  float oad = dot(oa, toLight), dba = dot(toLight, ba), baba = dot(ba, ba), oaba = dot(oa, ba);
  vec2 th = vec2(-oad * baba + dba * oaba, oaba - oad * dba) / max(baba - dba * dba, 1e-12);
  th.x = max(th.x, 0.0005);
  th.y = clamp(th.y, 0.0, 1.0);
  float d = length(a + ba * th.y - (p + toLight * th.x)) - r;
  return smoothstep(0.0, 1.0, clamp(6.0 * d / th.x + 0.15, 0.0, 1.0));
}

// Bends the normal by a height, from its differences on the screen.
vec3 bend(vec3 normal, float height, float amount) {
  vec3 dx = dFdx(vWorld), dy = dFdy(vWorld);
  vec3 r1 = cross(dy, normal), r2 = cross(normal, dx);
  float det = dot(dx, r1);
  vec3 gradient = sign(det) * (dFdx(height) * r1 + dFdy(height) * r2);
  return normalize(abs(det) * normal - amount * gradient);
}

struct Surface { vec3 colour; vec3 normal; float alpha; float gloss; float wet; };

vec3 shade(Surface s, vec3 view) {
  vec3 toLight = normalize(light - vWorld);
  float shadow = 1.0, sky = 1.0;
  for (int i = 0; i < 8; i++) {
    if (i >= capsuleCount) break;
    shadow *= lit(vWorld, toLight, capsuleFrom[i].xyz, capsuleTo[i], capsuleFrom[i].w);
    sky *= openness(vWorld, s.normal, capsuleFrom[i].xyz, capsuleTo[i], capsuleFrom[i].w);
  }
  float turned = dot(s.normal, toLight);
  float wrapped = clamp((turned + 0.3) / 1.3, 0.0, 1.0);
  // Light that went through flesh comes out redder.
  vec3 through = vec3(0.20, 0.05, 0.03) * smoothstep(-0.6, 0.4, turned) * (1.0 - wrapped);
  vec3 colour = s.colour * (ambient * sky + (0.25 + 0.75 * shadow) * wrapped * 0.95 + through);
  vec3 halfway = normalize(toLight + view);
  float shine = pow(max(dot(s.normal, halfway), 0.0), s.gloss);
  float rim = pow(1.0 - max(dot(s.normal, view), 0.0), 4.0);
  colour += (shadow * shine * s.wet + rim * 0.10 * s.wet * sky) * vec3(1.0, 0.97, 0.93);
  for (int i = 0; i < 4 && mapChannel < 0; i++) { // over a colour that tells a number a glow would tell another
    vec3 away = vWorld - glow[i].xyz;
    colour += glow[i].w * exp(-dot(away, away) / 2.2e-5) * vec3(0.9, 0.28, 0.06) * (0.25 + s.colour);
  }
  return colour;
}

// Heat first dries and blanches, then browns; where it has burnt edges through, blotches and streaks of
// char. What a tissue is browned to is its own: collagen to tan, fat to amber.
void burnt(inout Surface s, vec3 browned, float blotch) {
  // Heat made every rim: what is left of a parted edge is burnt even where its own nodes took up less.
  float e = max(vBurn.x, 0.9 * vBurn.z * vBurn.z);
  e += 0.3 * (blotch - 0.5) * smoothstep(0.05, 0.3, e);
  s.colour = mix(s.colour, vec3(0.74, 0.60, 0.45), 0.45 * smoothstep(0.12, 0.45, e));
  s.colour = mix(s.colour, browned, 0.85 * smoothstep(0.45, 0.9, e));
  // On the wall of a cut a third to a half of a vertex's edges are gone: that is as black as it gets.
  float c = clamp(min(2.0 * vBurn.y, 1.0) + 0.45 * vBurn.z, 0.0, 1.3) * (0.1 + 1.4 * blotch);
  s.colour = mix(s.colour, vec3(0.045, 0.026, 0.017), 0.92 * smoothstep(0.80, 1.20, c));
  s.wet *= 1.0 - 0.55 * smoothstep(0.3, 0.8, e);
  s.alpha = mix(s.alpha, 1.0, smoothstep(0.3, 0.7, e));
}

// Cut sheets end in fibres: near a rim, what lies between the fibres is gone.
void fray(float fibre) {
  if (vBurn.z > 0.72 + 0.62 * fibre) discard;
}

void finish(Surface s, vec3 view) {
  vec3 colour;
  if (mapChannel < 0) colour = shade(s, view);
  else {
    // As bright under the lamp as in the legend: more would bleach what tells a number.
    s.colour = 0.75 * pow(texture(colourMap, vec2(vBurn[mapChannel], 0.5)).rgb, vec3(2.2));
    s.wet = 0.05;
    s.alpha = 1.0;
    colour = shade(s, view);
  }
  fragment = linearToOutputTexel(vec4(colour, s.alpha));
}
`;

// A pearly sheet of collagen: pale bundles that wander, thinner and glassier between them, where what
// lies below shows through, with a few fine vessels.
const FASCIA_LOOK = /* glsl */ `
Surface fascia(vec3 normal, vec3 view, vec3 m, out float fibre, out float blotch) {
  float wander = n(m * 11.0);
  vec3 along = m + vec3(0.0, 0.0035 * (wander - 0.5), 0.0);
  float bundle = n(vec3(16.0 * along.x + 41.0 * along.y, 170.0 * along.yz));
  float strand = n(vec3(34.0 * along.x + 97.0 * along.y, 760.0 * along.yz) + 0.37);
  float crossing = n(vec3(m.y * 30.0 + m.x * 22.0, (m.x - 0.6 * m.y) * 300.0, m.z * 90.0));
  blotch = n(m * 34.0);
  fibre = 0.5 * bundle + 0.5 * strand;
  float weave = 0.44 * bundle + 0.26 * strand + 0.14 * crossing + 0.16 * blotch;
  float dense = smoothstep(0.32, 0.68, weave);
  Surface s;
  s.normal = bend(normal, weave, 0.00007);
  s.colour = mix(vec3(0.64, 0.37, 0.31), vec3(0.80, 0.63, 0.55), dense);
  s.colour = mix(s.colour, vec3(0.60, 0.22, 0.19), 0.30 * smoothstep(0.50, 0.72, blotch));
  float vessel = abs(n(m * vec3(13.0, 17.0, 15.0) + 0.31) - 0.5);
  s.colour = mix(s.colour, vec3(0.50, 0.07, 0.08), 0.55 * smoothstep(0.011, 0.002, vessel));
  float grazing = 1.0 - abs(dot(normal, view));
  s.alpha = clamp(mix(0.70, 0.92, dense) + 0.5 * grazing * grazing, 0.0, 1.0);
  s.gloss = 60.0;
  s.wet = 0.38;
  return s;
}
const vec3 TAN = vec3(0.40, 0.235, 0.115);
`;

const FASCIA = /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  float fibre, blotch;
  Surface s = fascia(normal, view, vMaterial, fibre, blotch);
  fray(fibre);
  burnt(s, TAN, 0.6 * fibre + 0.4 * blotch);
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
  float coarse = n(wave * 330.0 + 0.71);
  float fine = n(wave * 900.0 + 0.13);
  float thread = 0.62 * coarse + 0.38 * fine;
  if (thread < 0.36 + 0.26 * vTip) discard;
  float fibre, blotch;
  Surface s = fascia(normal, view, wave, fibre, blotch);
  s.colour *= 0.75 + 0.5 * fine;
  s.alpha = 1.0;
  s.wet = 0.1;
  burnt(s, TAN, 0.35 + 0.3 * vTip + 0.35 * fine);
  finish(s, view);
}`;

const MEMBRANE = /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  float lobe = n(vMaterial * 34.0);
  float film = n(vMaterial * 140.0);
  float vessel = n(vMaterial * vec3(15.0, 19.0, 17.0) + 0.61);
  fray(0.5 * film + 0.5 * lobe);
  Surface s;
  s.normal = bend(normal, lobe + 0.15 * film, 0.0016);
  vec3 fat = mix(vec3(0.62, 0.34, 0.09), vec3(0.86, 0.62, 0.24), smoothstep(0.3, 0.65, lobe));
  s.colour = mix(fat, vec3(0.74, 0.36, 0.29), 0.34);
  s.colour = mix(s.colour, vec3(0.42, 0.05, 0.05), 0.6 * smoothstep(0.018, 0.0, abs(vessel - 0.5)));
  s.alpha = 1.0;
  s.gloss = 90.0;
  s.wet = 0.62;
  burnt(s, vec3(0.46, 0.185, 0.07), 0.5 * film + 0.5 * n(vMaterial * 70.0));
  finish(s, view);
}`;

const FAT = /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(vNormal);
  if (dot(normal, view) < 0.0) normal = -normal;
  float lobe = n(vMaterial * 34.0);
  float grain = n(vMaterial * 150.0);
  float septum = smoothstep(0.05, 0.0, abs(lobe - 0.46));
  Surface s;
  s.normal = bend(normal, lobe + 0.2 * grain, 0.0024);
  s.colour = mix(vec3(0.66, 0.36, 0.07), vec3(0.92, 0.68, 0.22), smoothstep(0.3, 0.65, lobe));
  s.colour = mix(s.colour, vec3(0.80, 0.62, 0.48), 0.35 * septum);
  s.alpha = 1.0;
  s.gloss = 45.0;
  s.wet = 0.35;
  burnt(s, vec3(0.54, 0.235, 0.065), 0.5 * grain + 0.5 * n(vMaterial * 60.0 + 0.5));
  finish(s, view);
}`;

// The inside of fat, laid open: flat pieces, moist, with torn septa and a little blood.
const BARED = /* glsl */ `
void main() {
  vec3 view = normalize(cameraPosition - vWorld);
  vec3 normal = normalize(cross(dFdx(vWorld), dFdy(vWorld)));
  if (dot(normal, view) < 0.0) normal = -normal;
  float lobe = n(vMaterial * 60.0);
  float grain = n(vMaterial * 210.0);
  float blood = n(vMaterial * 24.0 + 0.23);
  Surface s;
  s.normal = bend(normal, lobe + 0.35 * grain, 0.0022);
  s.colour = mix(vec3(0.70, 0.27, 0.05), vec3(0.95, 0.66, 0.22), smoothstep(0.25, 0.7, 0.7 * lobe + 0.3 * grain));
  s.colour = mix(s.colour, vec3(0.45, 0.06, 0.04), 0.45 * smoothstep(0.52, 0.66, blood));
  s.alpha = 1.0;
  s.gloss = 60.0;
  s.wet = 0.5;
  burnt(s, vec3(0.42, 0.20, 0.05), 0.5 * grain + 0.5 * n(vMaterial * 60.0 + 0.5));
  finish(s, view);
}`;

export const FRAGMENTS = {
  fascia: COMMON + FASCIA_LOOK + FASCIA,
  fringe: COMMON + FASCIA_LOOK + FRINGE,
  membrane: COMMON + MEMBRANE,
  fat: COMMON + FAT,
  bared: COMMON + BARED,
} as const;
export type SurfaceKind = keyof typeof FRAGMENTS;
