// SPDX-License-Identifier: GPL-3.0-or-later
// Every text of the page, in English. The groups are named after the modules that show them. A text with values is a
// function.
import type { HelloResult, LIMITS, Layer, MODELS, PROJECTIONS } from '../wire/messages.gen';

export const en = {
  // ---- the document

  // ---- panels, a to i

  // ---- panels, l to z
  limits: {
    choices: { limit: 'Strain limit', model: 'Model', projection: 'Projection' },
    // the options of the three choices
    options: {
      none: 'none',
      target: 'target',
      range: 'range',
      neohookean: 'neohookean',
      corotated: 'corotated',
      stvk: 'stvk',
      energy: 'energy',
      closed_form: 'closed form',
      linearised: 'linearised',
    } satisfies Record<(typeof LIMITS | typeof MODELS | typeof PROJECTIONS)[number], string>,
    vectors: { target: 'Target', strain_min: 'Least strain', strain_max: 'Largest strain', shrink: 'Shrink' },
    // directions of the material; x, y and z are axes
    entries: {
      'along-fibres': 'along fibres',
      'across': 'across',
      'through': 'through',
      'shear-along-across': 'shear along/across',
      'shear-along-through': 'shear along/through',
      'shear-across-through': 'shear across/through',
      'x': 'x',
      'y': 'y',
      'z': 'z',
    },
    /** the name of an input, as in 'Target along fibres' */
    entryOf: (vector: string, entry: string) => `${vector} ${entry}`,
    titles: {
      target: 'squared stretch to which the limit pulls the tissue (target of F^T F)',
      shrink: 'squared stretch to which the rims of cuts shrink; 1: no shrinking',
    },
    outOfRange: (vector: string, least: number, most: number) => `${vector} must be numbers from ${least} to ${most}`,
  },
  materials: {
    title: 'Materials',
    empty: 'Join a session to see its materials.',
    kinds: { fascia: 'fascia', membrane: 'membrane', fat: 'fat', links: 'links' } satisfies Record<Layer['kind'], string>,
    layer: (name: string, kind: string) => `${name} (${kind})`,
    region: (layer: string, region: number) => `${layer}, region ${region}`,
    apply: 'Apply',
    gravity: 'Gravity',
    gravityAlong: (axis: string) => `Gravity ${axis}`,
  },
  mode: {
    modes: {
      operate: { name: 'Operate', title: 'Instrument, power, time and camera' },
      research: { name: 'Research', title: 'All of Operate, and sessions, tools, materials, view and plots' },
    },
  },
  operate: {
    instrument: 'Instrument',
    inHand: 'Instrument in hand',
    power: 'Power',
    powerSlider: 'Power: temperature of the hot tip',
    tip: (celsius: string) => `${celsius} °C at the tip`,
    takeFirst: 'Take the tool first',
    you: 'You',
    yourName: 'Your name',
    yourNameTitle: 'other people in the session see this name',
    driver: (person: string, tool: string) => `${person} uses the ${tool}.`,
    session: 'Session',
    camera: 'Camera',
  },
  overlay: {
    connecting: 'Connecting…',
    roles: { view: 'view', operate: 'operate', admin: 'admin' } satisfies Record<HelloResult['role'], string>,
    online: (server: string, role: string) => `${server} · ${role}`,
    lost: (reason: string) => `No connection: ${reason}. Trying again.`,
    tokenNeeded: 'An access token is needed',
    noSession: 'no session',
    /** one paragraph each */
    mouseHint: [
      'Move the mouse over the tissue to move the tool. Press to cut.',
      'Go slowly. Tissue needs a few seconds of heat before it parts.',
      'Drag beside the tissue to turn the view. Use the timeline below to view an earlier time.',
    ],
    fingerHint: [
      'Touch the tissue to cut. Choose Move to move the tool without heat.',
      'Go slowly. Tissue needs a few seconds of heat before it parts.',
      'Use two fingers to turn the view. Use the timeline to view an earlier time.',
    ],
    allKeys: 'All keys',
    manual: 'Manual',
    understood: 'Understood',
    help: 'Help',
    dismiss: 'Dismiss',
    asks: (person: string, tool: string) => `${person} asks for the ${tool}.`,
    handOver: 'Hand over',
    keep: 'Keep it',
    // read out by screen readers
    faces: (layer: string, count: number) => `${layer} ${count} faces`,
    toolAt: (tool: string, position: string) => `${tool} at ${position} mm`,
    reading: (layers: string, tool: string) => `${layers}. ${tool}`,
  },
  parameters: {
    /** shown for a parameter under the pointer */
    title: (meaning: string, least: string, most: string) => `${meaning}; ${least} to ${most}`,
    outOfRange: (name: string, meaning: string, least: string, most: string, unit: string) => `${name} (${meaning}) must be from ${least} to ${most} ${unit}`.trimEnd(),
  },

  // ---- hands, model and scene
};
