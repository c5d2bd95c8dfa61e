// SPDX-License-Identifier: GPL-3.0-or-later
// Tool shapes as solids, in the tool's frame (tip at the origin, shaft along +z, jaws open in x), with
// the proportions of the core's signed distances, see core/tool/README.md.
import { PARAMETERS, SHAPE_TRAITS, type Tool } from '../wire/messages.gen';

export type Vector3 = [number, number, number];

interface Part {
  hot: boolean;
  /** for parts that turn with the jaws: side, and `share` of the opening angle by which they turn about z = hinge */
  jaw?: { side: 1 | -1; share: number; hinge: number };
}
export type ToolPart = Part &
  (
    | { solid: 'capsule'; from: Vector3; to: Vector3; radius: number }
    | { solid: 'arc'; center: Vector3; bend: number; radius: number }
    | { solid: 'plate'; least: Vector3; most: Vector3; rounding: number }
  );

export interface ToolSizes {
  hot: number;
  tip: number;
  shaft: number;
  shaftLength: number;
  jawOpen: number;
  /** largest speed, m/s */
  maxSpeed: number;
}

function size(tool: Tool, name: string): number {
  const given = (tool as unknown as Record<string, unknown>)[name];
  return typeof given === 'number' ? given : PARAMETERS.tool.find((p) => p.name === name)!.default;
}

export function toolSizes(tool: Tool): ToolSizes {
  return {
    hot: size(tool, 'hot_radius_m'),
    tip: size(tool, 'tip_length_m'),
    shaft: size(tool, 'shaft_radius_m'),
    shaftLength: size(tool, 'shaft_length_m'),
    jawOpen: size(tool, 'jaw_open_rad'),
    maxSpeed: size(tool, 'max_speed_m_s'),
  };
}

const BLADE_SHARE = 0.4; // half thickness of blades and jaws over the radius

function shaft(s: ToolSizes, start: number): ToolPart {
  const low = start + s.shaft;
  const high = start + Math.max(s.shaftLength - s.shaft, s.shaft);
  return { solid: 'capsule', hot: false, from: [0, 0, low], to: [0, 0, high], radius: s.shaft };
}

function hook(s: ToolSizes): ToolPart[] {
  const half = s.tip / 2;
  const bend = s.tip / 4;
  const neck = Math.min(s.hot, s.shaft);
  const low = bend + s.hot + neck;
  const high = low + Math.max(s.tip, s.shaft);
  return [
    { solid: 'capsule', hot: true, from: [bend - half, 0, 0], to: [half, 0, 0], radius: s.hot },
    { solid: 'arc', hot: true, center: [bend - half, 0, bend], bend, radius: s.hot },
    { solid: 'capsule', hot: false, from: [-half, 0, low], to: [0, 0, high], radius: neck },
    shaft(s, high - s.shaft),
  ];
}

function needle(s: ToolSizes): ToolPart {
  return { solid: 'capsule', hot: true, from: [0, 0, 0], to: [0, 0, s.tip], radius: s.hot };
}

function spatula(s: ToolSizes): ToolPart[] {
  const t = BLADE_SHARE * s.hot;
  return [
    { solid: 'plate', hot: true, least: [-s.hot, -t, -t], most: [s.hot, t, s.tip + t], rounding: t },
    shaft(s, s.tip + t),
  ];
}

function shears(s: ToolSizes): ToolPart[] {
  const t = BLADE_SHARE * s.hot;
  const jaw = { side: 1, share: 1, hinge: s.tip } as const;
  return [
    needle(s),
    { solid: 'plate', hot: false, jaw, least: [s.hot, -s.hot, -s.tip], most: [s.hot + 2 * t, s.hot, 0], rounding: t },
    shaft(s, s.tip + s.hot),
  ];
}

function pair(make: (side: 1 | -1) => ToolPart[]): ToolPart[] {
  return [...make(1), ...make(-1)];
}

function bipolar(s: ToolSizes): ToolPart[] {
  const t = BLADE_SHARE * s.hot;
  const below = -s.tip - t;
  const jaws = pair((side) => {
    const jaw = { side, share: 0.5, hinge: s.tip } as const;
    return [
      { solid: 'plate', hot: true, jaw, least: [0, -s.hot, below], most: [2 * t, s.hot, -2 * t], rounding: t },
      { solid: 'plate', hot: false, jaw, least: [2 * t, -s.hot, below], most: [4 * t, s.hot, 0], rounding: t },
    ];
  });
  return [...jaws, shaft(s, s.tip)];
}

function grasper(s: ToolSizes): ToolPart[] {
  const t = BLADE_SHARE * s.shaft;
  const jaws = pair((side) => [
    {
      solid: 'plate',
      hot: false,
      jaw: { side, share: 0.5, hinge: s.tip },
      least: [0, -s.shaft, -s.tip - t],
      most: [2 * t, s.shaft, 0],
      rounding: t,
    },
  ]);
  return [...jaws, shaft(s, s.tip)];
}

export function toolParts(tool: Tool): ToolPart[] {
  const s = toolSizes(tool);
  switch (tool.shape) {
    case 'sphere':
      return [{ solid: 'capsule', hot: true, from: [0, 0, 0], to: [0, 0, 0], radius: s.hot }, shaft(s, s.hot)];
    case 'capsule':
      return [needle(s), shaft(s, s.tip + s.hot)];
    case 'hook':
      return hook(s);
    case 'spatula':
      return spatula(s);
    case 'bipolar':
      return bipolar(s);
    case 'shears':
      return shears(s);
    case 'grasper':
      return grasper(s);
    default: // the daemon sends the shape of every tool
      throw new Error(`the tool ${tool.name} has no shape`);
  }
}

/** A shape of tools. A request may name an instrument instead of one. */
export type Shape = NonNullable<Tool['shape']>;

export function hasJaws(shape: Tool['shape']): boolean {
  return shape !== undefined && SHAPE_TRAITS[shape].jaws;
}

export function hasHeat(shape: Tool['shape']): boolean {
  return shape !== undefined && SHAPE_TRAITS[shape].hot;
}
