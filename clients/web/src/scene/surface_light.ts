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
uniform vec2 scope;       // 1 if the lamp is at the camera, so that its light falls off; distance to the looked-at point
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

// Software computes both sides of an \`if\`, and what comes after a \`break\` once more: so loops break at their ends, and
// nothing long stands behind a condition. The first capsule is always there.
vec3 shade(Surface s, vec3 view) {
  vec3 toLight = normalize(light - vWorld);
  float shadow = 1.0, sky = 1.0;
  for (int i = 0; i < 8; i++) {
    shadow *= lit(vWorld, toLight, capsuleFrom[i].xyz, capsuleTo[i], capsuleFrom[i].w);
    sky *= openness(vWorld, s.normal, capsuleFrom[i].xyz, capsuleTo[i], capsuleFrom[i].w);
    if (i + 1 >= capsuleCount) break;
  }
  float turned = dot(s.normal, toLight);
  float wrapped = clamp((turned + 0.3) / 1.3, 0.0, 1.0);
  // Light that went through flesh comes out redder.
  vec3 through = vec3(0.20, 0.05, 0.03) * smoothstep(-0.6, 0.4, turned) * (1.0 - wrapped);
  float away = length(light - vWorld) / scope.y;
  float reaching = mix(1.0, min(1.30 / (0.40 + 0.60 * away * away), 1.7), scope.x);
  vec3 colour = s.colour * (ambient * sky + (0.25 + 0.75 * shadow) * wrapped * 0.95 * reaching + through);
  // In a closed body light comes back from red tissue all around.
  colour = max(mix(vec3(dot(colour, vec3(0.3, 0.5, 0.2))), colour, 1.0 + 0.08 * scope.x) * mix(vec3(1.0), vec3(1.05, 0.97, 0.96), scope.x), 0.0);
  vec3 halfway = normalize(toLight + view);
  // The film's slopes are steeper than the tissue's. With the light at the camera only slopes mirror it.
  vec3 smooth_ = normalize(vNormal) * (dot(vNormal, s.normal) < 0.0 ? -1.0 : 1.0);
  vec3 film = normalize(s.normal + 2.0 * scope.x * (s.normal - smooth_));
  float shine = pow(max(dot(film, halfway), 0.0), s.gloss * (1.0 - 0.35 * scope.x)) * (1.0 + 3.0 * scope.x);
  // A wet film mirrors the room: a lamp across the table with a wide bright frame, and some light from everywhere.
  float mirrored = max(dot(reflect(-view, s.normal), FAR_LAMP), 0.0);
  float m2 = mirrored * mirrored, m8 = m2 * m2 * m2 * m2, m24 = m8 * m8 * m8, m64 = m24 * m24 * m8 * m8;
  float across = (1.0 - scope.x) * (0.22 * m24 * m2 + 1.10 * m64 * m64 * m64 * m8) * sky; // to the powers of 26 and 200
  float grazing = 1.0 - max(dot(s.normal, view), 0.0);
  float rim = grazing * grazing * grazing * grazing;
  colour += s.wet * (shadow * shine * reaching + across + rim * 0.10 * sky) * vec3(1.0, 0.97, 0.93);
  float glowing = 0.0;
  for (int i = 0; i < 4; i++) {
    vec3 off = vWorld - glow[i].xyz;
    glowing += glow[i].w * exp(-dot(off, off) / 2.2e-5);
    if (glow[i].w <= 0.0) break;
  }
  // A glow would change a colour that stands for a number.
  return mapChannel < 0 ? colour + glowing * vec3(0.9, 0.28, 0.06) * (0.25 + s.colour) : colour;
}

// Heated tissue first blanches, then browns. It is black only where nearly all edges have parted. The colours change
// without a step. Each tissue has its own: collagen is cream and tan, fat is straw and amber.
void burnt(inout Surface s, vec3 pale, vec3 browned, float blotch) {
  blotch = clamp(2.2 * blotch - 0.6, 0.0, 1.0);
  // Heat made every rim: what is left of a parted edge is burnt even where its own nodes took up less.
  float e = max(vBurn.x, 0.85 * vBurn.z * vBurn.z);
  e += 0.3 * (blotch - 0.5) * smoothstep(0.05, 0.3, e);
  // Blanched tissue keeps its pattern: lobes and fibres are still seen.
  float was = clamp(0.45 + dot(s.colour, vec3(0.3, 0.5, 0.2)), 0.55, 1.15);
  s.colour = mix(s.colour, was * pale, 0.60 * smoothstep(0.08, 0.50, e));
  s.colour = mix(s.colour, browned, 0.55 * smoothstep(0.60, 1.10, e));
  // Where a cut went a third to a half of a vertex's edges are gone: brown there, narrowly at the lip itself, and
  // black only where nearly all are gone.
  float lip = smoothstep(0.55, 1.0, vBurn.z);
  float c = (vBurn.y + 0.30 * lip) * (0.68 + 0.64 * blotch);
  s.colour = mix(s.colour, browned * vec3(0.62, 0.52, 0.46), 0.85 * smoothstep(0.18, 0.60, c));
  s.colour = mix(s.colour, browned * vec3(0.20, 0.17, 0.16), 0.85 * smoothstep(0.55, 1.00, c));
  s.colour = mix(s.colour, vec3(0.030, 0.019, 0.014), 0.85 * smoothstep(0.95, 1.25, c));
  s.wet *= 1.0 - 0.80 * smoothstep(0.15, 0.70, e); // dried
  s.alpha = mix(s.alpha, 1.0, smoothstep(0.3, 0.7, e));
}

// As film does (after Narkowicz): bright places keep their colour instead of running into white.
vec3 toned(vec3 c) { return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0); }
const float EXPOSURE = 0.62;

// Under each tip a ring that is wider the higher the tip is over it, and closes around it as it comes down.
vec3 ringed(vec3 colour) {
  for (int i = 0; i < 4; i++) {
    float radius = tips[i].w;
    float away = length(vWorld.xy - tips[i].xy);
    float height = tips[i].z - radius - vWorld.z;
    float width = max(0.0002, fwidth(away));
    float on = 1.0 - smoothstep(0.5, 1.5, abs(away - radius - 0.5 * max(height, 0.0)) / width);
    on *= smoothstep(0.0003, 0.0012, height) * (1.0 - smoothstep(0.012, 0.025, height));
    colour = mix(colour, vec3(0.93, 0.98, 1.0), radius > 0.0 ? 0.6 * on : 0.0);
    if (radius <= 0.0) break;
  }
  return colour;
}

#ifdef BLOOD_M
// Blood on the surface: what lies under a film of 0.05 mm is seen through it, and nothing below 0.5 mm.
void bloody(inout Surface s) {
  float cover = 1.0 - exp(-BLOOD_M * vBurn.w / 0.00015);
  vec3 level = normalize(vNormal) * (dot(vNormal, s.normal) < 0.0 ? -1.0 : 1.0);
  s.normal = normalize(mix(s.normal, level, 0.85 * cover));
  s.colour = mix(s.colour, vec3(0.17, 0.004, 0.006), cover);
  s.alpha = mix(s.alpha, 1.0, cover);
  s.gloss = mix(s.gloss, 90.0, cover);
  s.wet = mix(s.wet, 0.6, cover);
}
#endif

void finish(Surface s, vec3 view) {
  if (dot(vWorld, clip.xyz) > clip.w) discard;
#ifdef BLOOD_M
  bloody(s);
#endif
  bool told = mapChannel >= 0;
  if (told) {
    // As bright under the lamp as in the legend: more would bleach what tells a number.
    s.colour = 0.75 * pow(texture(colourMap, vec2(vBurn[mapChannel], 0.5)).rgb, vec3(2.2));
    s.wet = 0.05;
    s.alpha = 1.0;
  }
  vec3 colour = shade(s, view);
  fragment = linearToOutputTexel(vec4(told ? colour : ringed(toned(EXPOSURE * colour)), s.alpha));
}

// What is only drawn has no scalar: grey beside colours that tell one.
void show(Surface s, vec3 view) {
  vec3 colour = ringed(toned(EXPOSURE * shade(s, view)));
  if (mapChannel >= 0) colour = vec3(0.5 * dot(colour, vec3(0.3, 0.5, 0.2)));
  fragment = linearToOutputTexel(vec4(colour, 1.0));
}
`;
