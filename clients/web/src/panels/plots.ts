// SPDX-License-Identifier: GPL-3.0-or-later
// What the tools did over the session, live plots of the last seconds, and samples as CSV.
import type uPlot from 'uplot';

import { samplesCsv } from '../model/samples';
import type { Model } from '../model/model';
import { STAGES } from '../wire/records';
import type { Sample } from '../wire/worker_messages';
import { button, element, save } from './dom';
import { makePlot, plotColour, resizePlot } from './plot';
import { sessionPlots } from './session_plots';
import type { Panel } from './tabs';

const SPAN_S = 20;
const DRAW_MS = 250;

interface Plot {
  title: string;
  series: readonly string[];
  values(sample: Sample): readonly (number | null)[];
}

const PLOTS: readonly Plot[] = [
  {
    title: 'Time of each stage of a step, ms',
    series: [...STAGES],
    values: ({ statistics }) => STAGES.map((_, i) => (statistics ? 1000 * statistics.stageS[i] : null)),
  },
  {
    title: 'Simulated time over real time',
    series: ['rate'],
    values: ({ statistics }) => [statistics ? statistics.realtimeFactor : null],
  },
  { title: 'Latency of frames, and time to decode one, ms', series: ['latency', 'decoding'], values: (s) => [s.latencyMs, s.decodeMs] },
  { title: 'Size of a frame, KB', series: ['frame'], values: (s) => [s.bytes / 1000] },
];

export function plotsPanel(model: Model): Panel {
  const body = element('div');
  const counts = element('output', { class: 'state' });
  const csv = button('Save as CSV', () =>
    save(`cautery-${model.session ?? 'statistics'}.csv`, new Blob([samplesCsv(model.samples)], { type: 'text/csv' })),
  );
  const session = sessionPlots(model);
  body.append(session.place, element('h2', {}, `The last ${SPAN_S} s`), counts, element('div', { class: 'buttons' }, csv));
  const places = PLOTS.map((plot) => {
    const place = element('div', { class: 'plot', aria: { role: 'img', label: plot.title } }, element('p', { class: 'of' }, plot.title));
    body.append(place);
    return place;
  });
  let plots: uPlot[] = [];
  let visible = false;
  const draw = (): void => {
    if (!visible) return;
    if (plots.length === 0) plots = PLOTS.map(({ series }, i) => makePlot(places[i], series.map((label, k) => ({ label, stroke: plotColour(k) }))));
    session.draw();
    const last = model.samples.at(-1);
    if (!last) return;
    const recent = model.samples.filter((sample) => sample.atS > last.atS - SPAN_S);
    const times = recent.map((sample) => sample.atS - last.atS);
    PLOTS.forEach((plot, p) => {
      const rows = recent.map((sample) => plot.values(sample));
      plots[p].setData([times, ...plot.series.map((_, s) => rows.map((row) => row[s]))]);
    });
    const seconds = last.atS - (recent[0]?.atS ?? last.atS);
    const bytes = recent.reduce((sum, sample) => sum + sample.bytes, 0);
    const rate = seconds > 0 ? [`${(recent.length / seconds).toFixed(0)} frames/s`, `${(bytes / seconds / 1000).toFixed(0)} KB/s`] : ['no frames received'];
    counts.value = [...rate, `${model.frame?.framesSkipped ?? 0} skipped`].join(', ');
  };
  setInterval(draw, DRAW_MS);
  new ResizeObserver(() => {
    if (!visible) return;
    plots.forEach((plot, i) => resizePlot(plot, places[i]));
    session.resize();
  }).observe(body);
  return {
    id: 'plots',
    title: 'Plots',
    body,
    shown: (now) => {
      visible = now;
      draw();
    },
  };
}
