// SPDX-License-Identifier: GPL-3.0-or-later
// Instruments that the daemon has profiles of: what is offered of them, and the request that makes a tool one of them.
import type { Instrument, InstrumentMode, Tool, ToolConfigure } from '../wire/messages.gen';

/** The mode of that name, or the instrument's first. */
export function modeNamed(instrument: Instrument, name: string): InstrumentMode | undefined {
  return instrument.modes.find(({ mode }) => mode === name) ?? instrument.modes[0];
}

/** The instrument and the mode whose settings the tool has, as far as its shape and its generator tell. */
export function instrumentOf(instruments: readonly Instrument[], tool: Tool): { instrument: string; mode: string } | null {
  for (const { name, shape, modes } of instruments) {
    const same = shape !== tool.shape ? undefined : modes.find((mode) => isSet(mode, tool));
    if (same) return { instrument: name, mode: same.mode };
  }
  return null;
}

/** Levels of shears differ in their power alone, which may be set: of the others the rest of the settings tells. */
function isSet(mode: InstrumentMode, tool: Tool): boolean {
  const others = mode.peak_v === tool.peak_v && mode.crest_factor === tool.crest_factor && mode.current_max_a === tool.current_max_a;
  return others && mode.load_rise_off === tool.load_rise_off && (tool.shape !== 'shears' || mode.power_w === tool.power_w);
}

/** The tool as that instrument. No size is named: those of the profile hold, and the pose stays. */
export function becoming(tool: string, instrument: string, mode: string, power: number): ToolConfigure {
  return { tool, instrument, mode, power_w: power };
}
