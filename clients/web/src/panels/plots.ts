// SPDX-License-Identifier: GPL-3.0-or-later
// What the tools did over the session, live plots of the last seconds, and samples as CSV.
import type uPlot from 'uplot';

import { samplesCsv } from '../model/samples';
import type { Model } from '../model/model';
import { text } from '../text/text';
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
    title: text.plots.stageTimes,
    series: STAGES.map((stage) => text.plots.stages[stage]),
    values: ({ statistics }) => STAGES.map((_, i) => (statistics ? 1000 * statistics.stageS[i] : null)),
  },
  {
    title: text.plots.speed,
    series: [text.plots.rate],
    values: ({ statistics }) => [statistics ? statistics.realtimeFactor : null],
  },
  { title: text.plots.frameTimes, series: [text.plots.latency, text.plots.decoding], values: (s) => [s.latencyMs, s.decodeMs] },
  { title: text.plots.frameSize, series: [text.plots.frame], values: (s) => [s.bytes / 1000] },
];

export function plotsPanel(model: Model): Panel {
  const body = element('div');
  const counts = element('output', { class: 'state' });
  const csv = button(text.plots.csv, () =>
    save(`cautery-${model.session ?? 'statistics'}.csv`, new Blob([samplesCsv(model.samples)], { type: 'text/csv' })),
  );
  const session = sessionPlots(model);
  body.append(session.place, element('h2', {}, text.plots.last(SPAN_S)), counts, element('div', { class: 'buttons' }, csv));
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
    const rate = seconds > 0 ? [text.plots.frameRate((recent.length / seconds).toFixed(0)), text.plots.dataRate((bytes / seconds / 1000).toFixed(0))] : [text.plots.noFrames];
    counts.value = [...rate, text.plots.skipped(model.frame?.framesSkipped ?? 0)].join(', ');
  };
  setInterval(draw, DRAW_MS);
  new ResizeObserver(() => {
    if (!visible) return;
    plots.forEach((plot, i) => resizePlot(plot, places[i]));
    session.resize();
  }).observe(body);
  return {
    id: 'plots',
    title: text.plots.title,
    body,
    shown: (now) => {
      visible = now;
      draw();
    },
  };
}
