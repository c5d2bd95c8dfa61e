// SPDX-License-Identifier: GPL-3.0-or-later
// The section that stores the state under a name and restores it.
import type { Control } from '../model/control';
import { text } from '../text/text';
import { attempt, button, element, field, problemPlace } from './dom';
import { nameInput } from './names';

/** Returns the names in the events of the timeline, as in `name=half-way branch=1 ...`. */
function namesIn(control: Control): string[] {
  const events = control.model.timeline?.events ?? [];
  return events.filter(({ kind }) => kind === 'snapshot').flatMap(({ detail }) => /^name=(\S+)/.exec(detail ?? '')?.[1] ?? []);
}

export function snapshotSection(control: Control): HTMLElement {
  const { model } = control;
  const problem = problemPlace();
  const said = element('p', { class: 'about', aria: { role: 'status' } });
  const name = nameInput({ name: 'snapshot', maxLength: 48, placeholder: text.snapshots.automatic });
  const known = element('datalist', { id: 'snapshots' });
  name.setAttribute('list', known.id);
  /** names of snapshots; those of other branches are not in the timeline, but can be restored */
  let taken: string[] = [];
  const seconds = (tick: number): string => `${(tick * (model.summary?.step_s ?? 0)).toFixed(2)} s`;
  const showKnown = (): void => {
    taken = [...new Set([...taken, ...namesIn(control)])];
    known.replaceChildren(...taken.map((value) => element('option', { value })));
  };
  const take = element('button', { type: 'submit' }, text.snapshots.take);
  const back = button(text.snapshots.restore, () => {
    const work = async (): Promise<void> => {
      if (name.value === '') throw new Error(text.snapshots.nameMissing);
      const tick = await control.restore(name.value);
      said.textContent = text.snapshots.restored(name.value, seconds(tick));
      await control.loadTimeline();
    };
    void attempt(problem, work, back);
  }, { id: 'restore' });
  const form = element('form', { class: 'form' }, field(text.snapshots.name, name), known, element('div', { class: 'buttons' }, take, back), said, problem);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const work = async (): Promise<void> => {
      const made = await control.call('session.snapshot', name.value === '' ? {} : { name: name.value });
      taken.push(made.name);
      name.value = made.name;
      said.textContent = text.snapshots.saved(made.name, seconds(made.tick));
      showKnown();
    };
    void attempt(problem, work, take);
  });
  const refresh = (): void => {
    for (const one of [take, back]) one.disabled = model.joined === null || !model.mayOperate;
  };
  model.on('timeline', showKnown);
  model.on('link', refresh);
  let session: string | null = null;
  model.on('joined', () => {
    if (model.session !== session) {
      session = model.session;
      taken = [];
      said.textContent = '';
      showKnown();
    }
    refresh();
  });
  refresh();
  return element('details', { class: 'section', id: 'snapshot' }, element('summary', {}, text.snapshots.title), form);
}
