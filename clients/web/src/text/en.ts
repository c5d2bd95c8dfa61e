// SPDX-License-Identifier: GPL-3.0-or-later
// Every text of the page, in English. The groups are named after the modules that show them. A text with values is a
// function.
import type { LIMITS, Layer, MODELS, PROJECTIONS } from '../wire/messages.gen';

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
  parameters: {
    /** shown for a parameter under the pointer */
    title: (meaning: string, least: string, most: string) => `${meaning}; ${least} to ${most}`,
    outOfRange: (name: string, meaning: string, least: string, most: string, unit: string) => `${name} (${meaning}) must be from ${least} to ${most} ${unit}`.trimEnd(),
  },

  // ---- hands, model and scene
};
