// SPDX-License-Identifier: GPL-3.0-or-later
// Profiles of instruments: finds the profile of a tool, and makes the request for another profile.
import type { Instrument, InstrumentMode, Tool, ToolConfigure } from '../wire/messages.gen';

/** Returns the mode with this name, or the first mode of the instrument. */
export function modeNamed(instrument: Instrument, name: string): InstrumentMode | undefined {
  return instrument.modes.find(({ mode }) => mode === name) ?? instrument.modes[0];
}

/** Returns the instrument and the mode with the tool's shape and generator settings; null: there is none. */
export function instrumentOf(instruments: readonly Instrument[], tool: Tool): { instrument: string; mode: string } | null {
  for (const { name, shape, modes } of instruments) {
    const same = shape !== tool.shape ? undefined : modes.find((mode) => isSet(mode, tool));
    if (same) return { instrument: name, mode: same.mode };
  }
  return null;
}

/** Returns whether a tool has the settings of a mode. Power can change within a mode and is not compared, except for
 * shears, whose levels differ only in power. */
function isSet(mode: InstrumentMode, tool: Tool): boolean {
  const others = mode.peak_v === tool.peak_v && mode.crest_factor === tool.crest_factor && mode.current_max_a === tool.current_max_a;
  return others && mode.load_rise_off === tool.load_rise_off && (tool.shape !== 'shears' || mode.power_w === tool.power_w);
}

/** Returns the request that gives a tool a profile. It has no sizes, so the sizes of the profile apply. The pose stays. */
export function becoming(tool: string, instrument: string, mode: string, power: number): ToolConfigure {
  return { tool, instrument, mode, power_w: power };
}
