// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the choices and requests of the generator's form, with the profiles of deploy/instruments.
import { readFileSync, readdirSync } from 'node:fs';

import { becoming, instrumentOf, modeNamed } from '../../../../clients/web/src/model/instruments';
import type { Instrument, InstrumentMode, Tool } from '../../../../clients/web/src/wire/messages.gen';

const FOLDER = new URL('../../../../deploy/instruments/', import.meta.url);
/** Values of a scene's tool that the scene does not set: cautery/scene.h. */
const USUAL = { peak_v: 1150, crest_factor: 1.4, current_max_a: 2, load_rise_off: 0 };

interface Profile {
  name: string;
  description: string;
  tool: Tool;
  modes: (Omit<InstrumentMode, 'mode'> & { name: string })[];
}

/** The instruments as the daemon lists them. */
const PROFILES: Instrument[] = readdirSync(FOLDER)
  .filter((file) => file.endsWith('.json'))
  .sort()
  .map((file) => {
    const { name, description, tool, modes } = JSON.parse(readFileSync(new URL(file, FOLDER), 'utf8')) as Profile;
    return { name, description, shape: tool.shape!, modes: modes.map((mode) => ({ ...USUAL, ...mode, mode: mode.name })) };
  });

/** Returns a tool with the settings of a mode. */
function toolIn(instrument: Instrument, { power_w, peak_v, crest_factor, current_max_a, load_rise_off }: InstrumentMode): Tool {
  return { name: 'tool', shape: instrument.shape as NonNullable<Tool['shape']>, power_w, peak_v, crest_factor, current_max_a, load_rise_off };
}

describe('instruments', () => {
  it('are found again by the settings of a tool, the levels of shears by their power', () => {
    expect(PROFILES.length).toBe(6);
    for (const instrument of PROFILES)
      for (const mode of instrument.modes)
        expect(instrumentOf(PROFILES, toolIn(instrument, mode))).toEqual({ instrument: instrument.name, mode: mode.mode });
  });

  it('are found with another power, and not with another voltage', () => {
    const hook = PROFILES.find(({ name }) => name === 'monopolar-hook')!;
    const tool = toolIn(hook, hook.modes[1]);
    expect(instrumentOf(PROFILES, { ...tool, power_w: 12 })).toEqual({ instrument: 'monopolar-hook', mode: 'blend' });
    expect(instrumentOf(PROFILES, { ...tool, peak_v: 777 })).toBeNull();
    expect(instrumentOf(PROFILES, { ...tool, shape: 'grasper' })).toBeNull();
  });

  it('have a mode of that name, or else their first', () => {
    const spatula = PROFILES.find(({ name }) => name === 'monopolar-spatula')!;
    expect(modeNamed(spatula, 'coagulation')?.mode).toBe('coagulation');
    expect(modeNamed(spatula, 'seal')?.mode).toBe('cut');
  });

  it('are asked for by name, without sizes that would replace the profile\'s', () => {
    expect(becoming('hook', 'monopolar-hook', 'cut', 30)).toEqual({ tool: 'hook', instrument: 'monopolar-hook', mode: 'cut', power_w: 30 });
  });
});
