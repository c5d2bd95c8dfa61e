// SPDX-License-Identifier: GPL-3.0-or-later
// Shows blood vessels: a warning while a vessel bleeds, a message about a new seal, and a list of all vessels.
import type { Model } from '../model/model';
import { figuresOf, stateWords, VesselWatch } from '../model/vessel_words';
import { text } from '../text/text';
import { element } from './dom';

const REFRESH_MS = 250; // numbers that change faster cannot be read
const NEWS_S = 6;

/** Returns a function that calls `work` at most every REFRESH_MS: at once, or a moment later. */
function unhurried(work: () => void): () => void {
  let next = 0;
  let waits = false;
  const run = (): void => {
    waits = false;
    next = performance.now() + REFRESH_MS;
    work();
  };
  return () => {
    if (waits) return;
    const wait = next - performance.now();
    waits = wait > 0;
    if (waits) setTimeout(run, wait);
    else run();
  };
}

/** Shows at the tool which vessels bleed, and for some seconds which vessel was sealed. */
export function watchVessels(model: Model): void {
  const watch = new VesselWatch(NEWS_S);
  const said = new Set<string>();
  let last = -1;
  const unsay = (stays: ReadonlySet<string>): void => {
    for (const key of said) {
      if (stays.has(key)) continue;
      said.delete(key);
      model.unsay(key);
    }
  };
  model.on('frame', ({ vessels, tick }) => {
    if (tick < last) watch.clear(); // after a rewind the old states do not count
    last = tick;
    if (vessels.length > 0 || said.size > 0) tell();
  });
  const tell = unhurried(() => {
    const stays = new Set<string>();
    for (const { key, warns, words, figures } of watch.take(model.frame?.vessels ?? [], performance.now() / 1000)) {
      if (key !== null) {
        stays.add(key);
        said.add(key);
      }
      model.say(warns ? 'warning' : 'info', words, { figures, ...(key === null ? {} : { key }) });
    }
    unsay(stays);
    if (said.size > 0) setTimeout(tell, REFRESH_MS); // messages must also end in a paused session, which sends no frames
  });
  model.on('joined', (joined) => {
    if (joined && joined.description.summary.session === model.frame?.session) return;
    watch.clear();
    unsay(new Set());
  });
}

/** Returns a list of the vessels of the session, hidden if there are none. */
export function vesselList(model: Model): HTMLElement {
  const list = element('ul', { class: 'vessels' });
  const section = element('section', { hidden: true, aria: { label: text.vessels.title } }, element('h2', {}, text.vessels.title), list);
  const show = unhurried(() => {
    const vessels = model.frame?.vessels ?? [];
    section.hidden = vessels.length === 0;
    while (list.children.length > vessels.length) list.lastElementChild?.remove();
    vessels.forEach((vessel, i) => {
      const line = list.children[i] ?? list.appendChild(element('li'));
      const figures = figuresOf(vessel);
      const state = stateWords(vessel);
      const words = figures === '' ? text.vessels.state(vessel.name, state) : text.vessels.stateAndFigures(vessel.name, state, figures);
      if (line.textContent !== words) line.textContent = words;
    });
  });
  model.on('frame', ({ vessels }) => {
    if (vessels.length > 0 || !section.hidden) show();
  });
  model.on('joined', (joined) => {
    if (!joined) section.hidden = true;
  });
  return section;
}
