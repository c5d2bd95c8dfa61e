// SPDX-License-Identifier: GPL-3.0-or-later
// Creates a plot with the colours of the page.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';

const HEIGHT = 120;
const LEAST_WIDTH = 200;
// Palette of Okabe and Ito, which colour-blind people can distinguish.
const COLOURS = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#56b4e9', '#d55e00', '#f0e442', '#999999'];

export function plotColour(series: number): string {
  return COLOURS[series % COLOURS.length];
}

export interface Series {
  label: string;
  stroke: string;
}

/** A name for each of several series; x in seconds. */
export function makePlot(place: HTMLElement, series: readonly Series[], more: Partial<uPlot.Options> = {}): uPlot {
  const style = getComputedStyle(document.documentElement);
  const [axis, grid] = [style.getPropertyValue('--ink-soft'), style.getPropertyValue('--line')];
  const side = { stroke: axis, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1 }, font: '11px system-ui, sans-serif' };
  const options: uPlot.Options = {
    width: Math.max(place.clientWidth, LEAST_WIDTH),
    height: HEIGHT,
    legend: { show: series.length > 1, live: false },
    cursor: { show: false },
    scales: { x: { time: false } },
    axes: [{ ...side, size: 28 }, { ...side, size: 50 }], // px: numbers, their gap and the ticks
    series: [{}, ...series.map((one) => ({ ...one, width: 1.5, spanGaps: true }))],
    ...more,
  };
  return new uPlot(options, [[], ...series.map(() => [])], place);
}

export function resizePlot(plot: uPlot, place: HTMLElement): void {
  plot.setSize({ width: Math.max(place.clientWidth, LEAST_WIDTH), height: HEIGHT });
}
