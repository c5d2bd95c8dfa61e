// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of decoded frames as CSV.
import { STAGES } from '../wire/records';
import type { Sample } from '../wire/worker_messages';

const COLUMNS: readonly (readonly [string, (sample: Sample) => number | null])[] = [
  ['time_s', (s) => s.atS],
  ['tick', (s) => s.tick],
  ['latency_ms', (s) => s.latencyMs],
  ['frame_bytes', (s) => s.bytes],
  ['decode_ms', (s) => s.decodeMs],
  ['force_n', (s) => s.forceN],
  ['energy_j', (s) => s.energyJ],
  ['realtime_factor', (s) => s.statistics?.realtimeFactor ?? null],
  ['step_cost_s', (s) => s.statistics?.stepCostS ?? null],
  ...STAGES.map((stage, i) => [`${stage}_s`, (s: Sample) => s.statistics?.stageS[i] ?? null] as const),
  ['iterations', (s) => s.statistics?.iterations ?? null],
  ['edges_parted', (s) => s.statistics?.edgesParted ?? null],
  ['elements_removed', (s) => s.statistics?.elementsRemoved ?? null],
  ['elements_torn', (s) => s.statistics?.elementsTorn ?? null],
  ['pending_downdates', (s) => s.statistics?.pendingDowndates ?? null],
  ['contacts', (s) => s.statistics?.contacts ?? null],
  ['contacts_left_out', (s) => s.statistics?.contactsLeftOut ?? null],
  ['touching_cut_short', (s) => s.statistics?.touchingCutShort ?? null],
];

export function samplesCsv(samples: readonly Sample[]): string {
  const head = COLUMNS.map(([name]) => name).join(',');
  const rows = samples.map((sample) => COLUMNS.map(([, value]) => value(sample) ?? '').join(','));
  return [head, ...rows, ''].join('\n');
}
