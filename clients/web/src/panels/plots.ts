// SPDX-License-Identifier: GPL-3.0-or-later
// Live plots of the last seconds, and all samples as CSV.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';

import { samplesCsv } from '../model/samples';
import type { Model } from '../model/model';
import { STAGES } from '../wire/records';
import type { Sample } from '../wire/worker_messages';
import { button, element, save } from './dom';
import type { Panel } from './tabs';

const SPAN_S = 20;
const DRAW_MS = 250;
const HEIGHT = 120;
// Okabe and Ito's palette: told apart by colour-blind eyes.
const COLOURS = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#56b4e9', '#d55e00', '#f0e442', '#999999'];

interface Plot {
  title: string;
  series: readonly string[];
  values(sample: Sample): readonly (number | null)[];
}

const PLOTS: readonly Plot[] = [
  {
    title: 'Step by stage, ms',
    series: [...STAGES],
    values: ({ statistics }) => STAGES.map((_, i) => (statistics ? 1000 * statistics.stageS[i] : null)),
  },
  {
    title: 'Rate of simulated to wall time',
    series: ['rate'],
    values: ({ statistics }) => [statistics ? statistics.realtimeFactor : null],
  },
  { title: 'Latency and decoding, ms', series: ['latency', 'decoding'], values: (s) => [s.latencyMs, s.decodeMs] },
  { title: 'Frame, KB', series: ['frame'], values: (s) => [s.bytes / 1000] },
  { title: 'Force, N', series: ['force'], values: (s) => [s.forceN] },
  { title: 'Energy taken up, J', series: ['energy'], values: (s) => [s.energyJ] },
];

function ink(): { axis: string; grid: string } {
  const style = getComputedStyle(document.documentElement);
  return { axis: style.getPropertyValue('--ink-soft'), grid: style.getPropertyValue('--line') };
}

function makePlot(place: HTMLElement, plot: Plot): uPlot {
  const { axis, grid } = ink();
  const side = { stroke: axis, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1 }, font: '11px system-ui, sans-serif' };
  const options: uPlot.Options = {
    width: Math.max(place.clientWidth, 200),
    height: HEIGHT,
    legend: { show: plot.series.length > 1, live: false },
    cursor: { show: false },
    scales: { x: { time: false } },
    axes: [{ ...side, size: 22 }, { ...side, size: 44 }],
    series: [{}, ...plot.series.map((label, i) => ({ label, stroke: COLOURS[i], width: 1.5, spanGaps: true }))],
  };
  return new uPlot(options, [[], ...plot.series.map(() => [])], place);
}

export function plotsPanel(model: Model): Panel {
  const body = element('div');
  const counts = element('output', { class: 'state' });
  const csv = button('Save as CSV', () =>
    save(`cautery-${model.session ?? 'statistics'}.csv`, new Blob([samplesCsv(model.samples)], { type: 'text/csv' })),
  );
  body.append(counts, element('div', { class: 'buttons' }, csv));
  const places = PLOTS.map((plot) => {
    const place = element('figure', { class: 'plot', aria: { role: 'img', label: plot.title } }, element('figcaption', {}, plot.title));
    body.append(place);
    return place;
  });
  let plots: uPlot[] = [];
  let visible = false;
  const draw = (): void => {
    if (!visible) return;
    if (plots.length === 0) plots = PLOTS.map((plot, i) => makePlot(places[i], plot));
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
    const rate = seconds > 0 ? `${(recent.length / seconds).toFixed(0)} frames/s, ${(bytes / seconds / 1000).toFixed(0)} KB/s` : '';
    counts.value = `${rate}; ${model.frame?.framesSkipped ?? 0} skipped`;
  };
  setInterval(draw, DRAW_MS);
  new ResizeObserver(() => {
    if (!visible) return;
    plots.forEach((plot, i) => plot.setSize({ width: Math.max(places[i].clientWidth, 200), height: HEIGHT }));
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
