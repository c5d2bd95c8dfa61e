// SPDX-License-Identifier: GPL-3.0-or-later
// The time bar: pause, step, speed, and the timeline with its events, from which a session can be rewound.
import type { Control } from '../model/control';
import { EVENT_WORDS, momentsOf } from '../model/moments';
import { text } from '../text/text';
import type { TimelineEvent } from '../wire/messages.gen';
import type { Frame } from '../wire/worker_messages';
import { ask } from './ask';
import { attempt, button, byId, element, problemPlace } from './dom';

const SPEEDS = [0.1, 0.25, 0.5, 1, 2];
const REFRESH_MS = 2000;
/** Interval in which the time of a running session is written. Each change makes the browser compute the layout again. */
const WRITE_MS = 100;

const research = (): boolean => document.body.dataset['mode'] === 'research';

function marks(events: readonly TimelineEvent[], least: number, most: number): SVGElement {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 1000 10');
  svg.setAttribute('preserveAspectRatio', 'none');
  svg.setAttribute('aria-hidden', 'true');
  for (const event of events) {
    const mark = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
    mark.setAttribute('class', `mark ${event.kind}`);
    mark.setAttribute('x', String((1000 * (event.tick - least)) / Math.max(most - least, 1) - 1));
    mark.setAttribute('width', '3');
    mark.setAttribute('height', '10');
    svg.append(mark);
  }
  return svg;
}

/** Fills the list of past moments. */
function nameMoments(place: HTMLSelectElement, events: readonly TimelineEvent[], seconds: (tick: number) => string): void {
  const last = String(events.at(-1)?.tick);
  place.hidden = events.length === 0;
  if (place.dataset['last'] === last && place.dataset['count'] === String(events.length)) return;
  Object.assign(place.dataset, { last, count: String(events.length) });
  const options = momentsOf(events, seconds).map(({ tick, words }) => element('option', { value: String(tick) }, words));
  place.replaceChildren(element('option', { value: '', disabled: true, selected: true }, text.time.events), ...options);
}

export function timeBar(control: Control, shared: number | null): void {
  const { model } = control;
  const problem = problemPlace();
  const pause = button(text.time.pause, () => {
    const paused = model.frame?.paused === true;
    void attempt(problem, () => control.call(paused ? 'session.resume' : 'session.pause', {}), pause);
  }, { id: 'pause' });
  const step = button(text.time.step, () => void attempt(problem, () => control.call('session.step', { ticks: 1 }), step), { id: 'step', class: 'research-only' });
  const reset = button(text.time.reset, () => {
    void ask(text.time.resetQuestion, text.time.resetLoss, text.time.reset).then((sure) => {
      if (sure) void attempt(problem, () => control.reset(), reset);
    });
  }, { id: 'reset', title: text.time.resetTitle });
  const speed = element('select', { name: 'speed', class: 'research-only', aria: { label: text.time.speed } }, ...SPEEDS.map((s) => element('option', { value: String(s) }, `${s} ×`)));
  speed.value = '1';
  speed.addEventListener('change', () => void attempt(problem, () => control.call('session.speed', { speed: Number(speed.value) })));
  const slider = element('input', { type: 'range', name: 'tick', id: 'tick', min: '0', max: '1', value: '1', aria: { label: text.time.timeline } });
  const track = element('div', { class: 'track' }, slider);
  const rewind = button(text.time.rewindHere, () => {
    const tick = slider.valueAsNumber;
    void ask(text.time.rewindQuestion(seconds(tick)), text.time.rewindLoss, text.time.rewind).then((sure) => {
      if (sure) void attempt(problem, () => control.rewind(tick).then(() => model.hold(null)), rewind);
    });
  }, { id: 'rewind', hidden: true });
  const moments = element('select', { id: 'moments', class: 'moments', aria: { label: text.time.eventsLabel } });
  moments.addEventListener('change', () => model.hold(Number(moments.value)));
  const now = element('output', { class: 'now', id: 'now' });
  const seconds = (tick: number): string => `${(tick * (model.summary?.step_s ?? 1 / 60)).toFixed(2)} s`;
  const tell = (): void => {
    rewind.textContent = text.time.rewindTo(seconds(slider.valueAsNumber));
    slider.setAttribute('aria-valuetext', seconds(slider.valueAsNumber));
  };
  slider.addEventListener('input', () => {
    model.hold(slider.valueAsNumber < Number(slider.max) ? slider.valueAsNumber : null);
  });
  byId('time').append(pause, step, reset, speed, track, moments, rewind, now, problem);

  const place = (): void => {
    const { timeline, frame } = model;
    const least = timeline?.oldest_tick ?? 0;
    const most = Math.max(frame?.tick ?? 0, least + 1);
    slider.min = String(least);
    slider.max = String(most);
    slider.value = String(model.held ?? most);
    tell();
    rewind.hidden = model.held === null;
  };
  const drawMarks = (): void => {
    place();
    track.querySelector('svg')?.remove();
    const events = (model.timeline?.events ?? []).filter(({ kind, tick }) => kind in EVENT_WORDS && tick >= Number(slider.min));
    track.prepend(marks(events, Number(slider.min), Number(slider.max)));
    if (document.activeElement !== moments) nameMoments(moments, events, seconds);
  };
  const enable = (): void => {
    const usable = model.mayOperate && model.joined !== null;
    for (const control_ of [pause, reset, speed, rewind]) control_.disabled = !usable;
    slider.disabled = model.joined === null; // every user who may watch may also view the past
    step.disabled = !usable || model.frame?.paused !== true;
  };
  model.on('timeline', () => {
    drawMarks();
    showShared();
  });
  model.on('held', place);
  model.on('link', enable);
  model.on('joined', (joined) => {
    enable();
    if (joined) void attempt(problem, () => control.loadTimeline());
  });
  // A shared moment is only viewed, because a rewind would affect everyone in the session. When both the timeline and the
  // first frame are known, it is clear whether the moment can be reached.
  const showShared = (): void => {
    const { timeline, frame } = model;
    if (shared === null || !timeline || !frame) return;
    const tick = shared;
    shared = null;
    if (tick >= timeline.oldest_tick && tick < frame.tick) model.hold(tick);
  };
  let paused: boolean | null = null;
  let writtenMs = 0;
  const writeTime = (frame: Frame): void => {
    if (!frame.paused && frame.paused === paused && performance.now() - writtenMs < WRITE_MS) return;
    writtenMs = performance.now();
    const rate = frame.samples.at(-1)?.statistics?.realtimeFactor;
    const words = [`${frame.timeS.toFixed(2)} s`];
    if (frame.faulted || frame.paused) words.push(frame.faulted ? text.time.faulted : text.time.paused);
    if (research()) words.push(text.time.tick(frame.tick));
    if (rate !== undefined && !frame.paused && research()) words.push(`${rate.toFixed(2)} ×`);
    const line = words.join(' · ');
    if (now.value !== line) now.value = line;
  };
  model.on('frame', (frame) => {
    showShared();
    writeTime(frame);
    if (frame.paused !== paused) {
      paused = frame.paused;
      pause.textContent = paused ? text.time.resume : text.time.pause;
      enable();
    }
  });
  setInterval(() => {
    if (model.timeline && !document.hidden) drawMarks();
  }, REFRESH_MS);
  enable();
}
