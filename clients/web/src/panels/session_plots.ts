// SPDX-License-Identifier: GPL-3.0-or-later
// Plots temperature, force and energy of each tool over the session. All plots have one cursor: the time under the
// pointer, else the time at which the timeline is held. A press holds the timeline at that time.
import type uPlot from 'uplot';

import type { ToolMoment } from '../model/history';
import type { Model } from '../model/model';
import { text } from '../text/text';
import { element, short } from './dom';
import { makePlot, plotColour, resizePlot } from './plot';

const PLOTS: readonly (readonly [string, string, (moment: ToolMoment) => number])[] = [
  [text.sessionPlots.temperature, '°C', ({ temperatureC }) => temperatureC],
  [text.sessionPlots.force, 'N', ({ forceN }) => forceN],
  [text.sessionPlots.energy, 'J', ({ energyJ }) => energyJ],
];
const CURSOR = 'session';
/** Largest number of points; more cannot be distinguished in the width of a panel. */
const POINTS_MAX = 1500;

export interface SessionPlots {
  place: HTMLElement;
  draw(): void;
  resize(): void;
}

export function sessionPlots(model: Model): SessionPlots {
  const figures = PLOTS.map(([title]) => element('div', { class: 'plot', aria: { role: 'img', label: text.sessionPlots.over(title) } }, element('p', { class: 'of' }, title)));
  const told = element('output', { class: 'state', id: 'at-cursor' });
  const place = element('section', { class: 'form', aria: { label: text.sessionPlots.title } }, element('h2', {}, text.sessionPlots.title), told, ...figures);
  let plots: uPlot[] = [];
  let tools = '';
  let pointed: number | null = null;
  const step = (): number => model.summary?.step_s ?? 1 / 60;

  const tell = (): void => {
    const tick = pointed ?? model.held;
    const moment = tick === null ? model.history.moments.at(-1) : model.history.at(tick);
    const each = [...(moment?.tools ?? [])].map(([name, { temperatureC, forceN, energyJ }]) => `${name} ${temperatureC.toFixed(0)} °C, ${short(forceN, 2)} N, ${short(energyJ, 3)} J`);
    const when = moment ? `${(moment.tick * step()).toFixed(2)} s` : text.sessionPlots.noValues;
    const words = `${when}${moment ? ': ' : ''}${each.join('; ')}`;
    if (told.value !== words) told.value = words;
  };
  /** Draws a line at the time at which the timeline is held. */
  const drawHeld = (plot: uPlot): void => {
    if (model.held === null || !plot.ctx) return;
    const x = plot.valToPos(model.held * step(), 'x', true);
    const { left, top, width, height } = plot.bbox;
    if (x < left || x > left + width) return;
    plot.ctx.save();
    plot.ctx.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue('--accent');
    plot.ctx.lineWidth = 2;
    plot.ctx.beginPath();
    plot.ctx.moveTo(x, top);
    plot.ctx.lineTo(x, top + height);
    plot.ctx.stroke();
    plot.ctx.restore();
  };
  const make = (names: readonly string[]): void => {
    for (const plot of plots) plot.destroy();
    plots = figures.map((figure) =>
      makePlot(figure, names.map((label, i) => ({ label, stroke: plotColour(i) })), {
        cursor: { y: false, points: { show: false }, drag: { x: false, y: false }, sync: { key: CURSOR, setSeries: false } },
        hooks: {
          draw: [drawHeld],
          setCursor: [(plot) => {
            const left = plot.cursor.left ?? -1;
            pointed = left < 0 ? null : Math.round(plot.posToVal(left, 'x') / step());
            tell();
          }],
          ready: [(plot) => plot.over.addEventListener('click', () => {
            if (pointed !== null) model.hold(pointed < (model.frame?.tick ?? 0) ? pointed : null);
          })],
        },
      }),
    );
  };
  const draw = (): void => {
    const { moments, tools: names } = model.history;
    if (plots.length === 0 || names.join() !== tools) make(names);
    tools = names.join();
    const every = Math.ceil(moments.length / POINTS_MAX);
    const shown = moments.filter((_, i) => i % every === 0 || i === moments.length - 1);
    const times = shown.map(({ tick }) => tick * step());
    PLOTS.forEach(([, , value], p) => {
      const series = names.map((name) => shown.map(({ tools: all }) => (all.has(name) ? value(all.get(name)!) : null)));
      plots[p].setData([times, ...series]);
    });
    tell();
  };
  model.on('held', () => {
    if (!place.checkVisibility()) return;
    for (const plot of plots) plot.redraw(false);
    tell();
  });
  return {
    place,
    draw,
    resize: () => plots.forEach((plot, i) => resizePlot(plot, figures[i])),
  };
}
