// SPDX-License-Identifier: GPL-3.0-or-later
// Profiles of instruments: which one a tool has, and the request that gives it another one.
import type { Instrument, InstrumentMode, Tool, ToolConfigure } from '../wire/messages.gen';

/** The mode of that name, or the instrument's first. */
export function modeNamed(instrument: Instrument, name: string): InstrumentMode | undefined {
  return instrument.modes.find(({ mode }) => mode === name) ?? instrument.modes[0];
}

/** The instrument and the mode that have the tool's shape and generator settings; null: none has. */
export function instrumentOf(instruments: readonly Instrument[], tool: Tool): { instrument: string; mode: string } | null {
  for (const { name, shape, modes } of instruments) {
    const same = shape !== tool.shape ? undefined : modes.find((mode) => isSet(mode, tool));
    if (same) return { instrument: name, mode: same.mode };
  }
  return null;
}

/** Power may be changed within a mode, so it is not compared. Levels of shears differ by nothing else. */
function isSet(mode: InstrumentMode, tool: Tool): boolean {
  const others = mode.peak_v === tool.peak_v && mode.crest_factor === tool.crest_factor && mode.current_max_a === tool.current_max_a;
  return others && mode.load_rise_off === tool.load_rise_off && (tool.shape !== 'shears' || mode.power_w === tool.power_w);
}

/** The request that gives a tool a profile. It names no size, so the profile's sizes hold. The pose stays. */
export function becoming(tool: string, instrument: string, mode: string, power: number): ToolConfigure {
  return { tool, instrument, mode, power_w: power };
}
