// SPDX-License-Identifier: GPL-3.0-or-later
// What all surfaces of the picture share: vertex shaders, lamps and shadow, burn, and how colours become a
// picture's. Lengths in metres, colours linear.

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

export const SURFACE_VERTEX = /* glsl */ `
in vec3 material;
in vec4 burn;
in float tip;
out vec3 vWorld;
out vec3 vNormal;
out vec4 vBurn;
out vec3 vMaterial;
out float vTip;
void main() {
  vWorld = position;
  vNormal = normal;
  vBurn = burn;
  vMaterial = material;
  vTip = tip;
  gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
}`;

export const COMMON = /* glsl */ `
precision highp float;
precision highp sampler3D;
in vec3 vWorld;
in vec3 vNormal;
in vec4 vBurn;
in vec3 vMaterial;
out vec4 fragment;
uniform sampler3D noise;
uniform sampler3D lobes;     // 1 in the middle of a lobe of fat, 0 between lobes
uniform sampler2D vessels;   // above 0.5 inside a vessel
uniform sampler2D colourMap;
uniform int mapChannel;   // -1: as tissue; else the channel of burn shown as colour
uniform vec3 light;       // the lamp, world
uniform float ambient;
uniform vec4 clip;        // what is beyond this plane is cut away from the picture
uniform int capsuleCount;
uniform vec4 capsuleFrom[8]; // xyz and radius: parts of instruments that cast shadow
uniform vec3 capsuleTo[8];
uniform vec4 glow[4];     // xyz of hot tips and how much they glow
uniform vec4 tips[4];     // xyz of tips and the radius of what works there; 0: no more of them

float n(vec3 p) { return texture(noise, p).r; }
float lobed(vec3 p) { return texture(lobes, p).r; }
// Vessels in a plane of 14 cm; they lie in what they run through, so that only their middle is dark.
float vessel(vec2 at) { return smoothstep(0.45, 0.55, texture(vessels, at / 0.14).r); }

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

// Steps in the material along the picture's axes, never shorter than a feature of the surface.
struct Steps { vec3 x; vec3 y; vec2 longer; };
Steps steps(float shortest) {
  vec3 x = dFdx(vMaterial), y = dFdy(vMaterial);
  vec2 longer = max(vec2(shortest) / max(vec2(length(x), length(y)), 1e-9), 1.0);
  return Steps(x * longer.x, y * longer.y, longer);
}
// Bends the normal by a height that rises by so much over those steps. The heights come from textures with
// mip-maps, so that what is finer than the picture does not sparkle in it.
vec3 bend(vec3 normal, Steps over, vec2 rise, float amount) {
  vec3 dx = dFdx(vWorld), dy = dFdy(vWorld);
  vec3 r1 = cross(dy, normal), r2 = cross(normal, dx);
  float det = dot(dx, r1);
  vec2 slope = rise / over.longer;
  vec3 gradient = sign(det) * (slope.x * r1 + slope.y * r2);
  return normalize(abs(det) * normal - amount * gradient);
}

// Where the camera is at home, flat wet tissue left of the picture's middle mirrors it.
const vec3 FAR_LAMP = vec3(-0.220, 0.700, 0.679);

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
  // A wet film mirrors the room: a lamp across the table with a wide bright frame, and some light from everywhere.
  float mirrored = max(dot(reflect(-view, s.normal), FAR_LAMP), 0.0);
  float m2 = mirrored * mirrored, m8 = m2 * m2 * m2 * m2, m24 = m8 * m8 * m8, m64 = m24 * m24 * m8 * m8;
  float across = (0.22 * m24 * m2 + 1.10 * m64 * m64 * m64 * m8) * sky; // to the powers of 26 and 200
  float grazing = 1.0 - max(dot(s.normal, view), 0.0);
  float rim = grazing * grazing * grazing * grazing;
  colour += s.wet * (shadow * shine + across + rim * 0.10 * sky) * vec3(1.0, 0.97, 0.93);
  for (int i = 0; i < 4 && mapChannel < 0; i++) { // over a colour that tells a number a glow would tell another
    if (glow[i].w <= 0.0) continue;
    vec3 away = vWorld - glow[i].xyz;
    colour += glow[i].w * exp(-dot(away, away) / 2.2e-5) * vec3(0.9, 0.28, 0.06) * (0.25 + s.colour);
  }
  return colour;
}

// Heated tissue first blanches, then browns. It is black only where nearly all edges have parted. The colours change
// without a step. Each tissue has its own: collagen is cream and tan, fat is straw and amber.
void burnt(inout Surface s, vec3 pale, vec3 browned, float blotch) {
  blotch = clamp(2.2 * blotch - 0.6, 0.0, 1.0);
  // Heat made every rim: what is left of a parted edge is burnt even where its own nodes took up less.
  float e = max(vBurn.x, 0.85 * vBurn.z * vBurn.z);
  e += 0.3 * (blotch - 0.5) * smoothstep(0.05, 0.3, e);
  s.colour = mix(s.colour, pale, 0.60 * smoothstep(0.08, 0.50, e));
  s.colour = mix(s.colour, browned, 0.55 * smoothstep(0.60, 1.10, e));
  // Where a cut went a third to a half of a vertex's edges are gone: brown there, narrowly at the lip itself, and
  // black only where nearly all are gone.
  float lip = smoothstep(0.55, 1.0, vBurn.z);
  float c = (vBurn.y + 0.30 * lip) * (0.40 + 1.2 * blotch);
  s.colour = mix(s.colour, browned * vec3(0.62, 0.52, 0.46), 0.85 * smoothstep(0.18, 0.60, c));
  s.colour = mix(s.colour, browned * vec3(0.20, 0.17, 0.16), 0.85 * smoothstep(0.55, 1.00, c));
  s.colour = mix(s.colour, vec3(0.030, 0.019, 0.014), 0.85 * smoothstep(0.95, 1.25, c));
  s.wet *= 1.0 - 0.45 * smoothstep(0.3, 0.9, e);
  s.alpha = mix(s.alpha, 1.0, smoothstep(0.3, 0.7, e));
}

// As film does (after Narkowicz): bright places keep their colour instead of running into white.
vec3 toned(vec3 c) { return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0); }
const float EXPOSURE = 0.62;

// Under each tip a ring that is wider the higher the tip is over it, and closes around it as it comes down.
vec3 ringed(vec3 colour) {
  for (int i = 0; i < 4; i++) {
    float radius = tips[i].w;
    if (radius <= 0.0) break;
    float away = length(vWorld.xy - tips[i].xy);
    float height = tips[i].z - radius - vWorld.z;
    float width = max(0.0002, fwidth(away));
    float on = 1.0 - smoothstep(0.5, 1.5, abs(away - radius - 0.5 * max(height, 0.0)) / width);
    on *= smoothstep(0.0003, 0.0012, height) * (1.0 - smoothstep(0.012, 0.025, height));
    colour = mix(colour, vec3(0.93, 0.98, 1.0), 0.6 * on);
  }
  return colour;
}

void finish(Surface s, vec3 view) {
  if (dot(vWorld, clip.xyz) > clip.w) discard;
  vec3 colour;
  if (mapChannel < 0) colour = ringed(toned(EXPOSURE * shade(s, view)));
  else {
    // As bright under the lamp as in the legend: more would bleach what tells a number.
    s.colour = 0.75 * pow(texture(colourMap, vec2(vBurn[mapChannel], 0.5)).rgb, vec3(2.2));
    s.wet = 0.05;
    s.alpha = 1.0;
    colour = shade(s, view);
  }
  fragment = linearToOutputTexel(vec4(colour, s.alpha));
}

// What is only drawn has no scalar: grey beside colours that tell one.
void show(Surface s, vec3 view) {
  vec3 colour = ringed(toned(EXPOSURE * shade(s, view)));
  if (mapChannel >= 0) colour = vec3(0.5 * dot(colour, vec3(0.3, 0.5, 0.2)));
  fragment = linearToOutputTexel(vec4(colour, 1.0));
}
`;
