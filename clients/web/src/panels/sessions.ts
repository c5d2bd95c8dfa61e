// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions: join, create from a scene with its parameters, upload a mesh, fork, destroy.
import type { Control } from '../model/control';
import { text } from '../text/text';
import type { Link } from '../wire/link';
import type { Scene, SessionSummary } from '../wire/messages.gen';
import { ask } from './ask';
import { attempt, button, element, field, problemPlace, save } from './dom';
import { nameInput } from './names';
import { snapshotSection } from './snapshots';
import type { Panel } from './tabs';
import { uploadForm } from './upload';

const REFRESH_MS = 5000; // refresh of states and counts while the list is visible

function detailsOf({ scene, state, time_s, subscriber_count }: SessionSummary): string {
  return text.sessions.details(scene, text.sessions.states[state], time_s.toFixed(1), subscriber_count);
}

function row(control: Control, summary: SessionSummary, problem: HTMLElement): HTMLElement {
  const here = summary.session === control.model.session;
  const details = detailsOf(summary);
  const join = button(summary.session, () => control.watch(summary.session), {
    class: 'session-name',
    title: text.sessions.watch(summary.session),
    aria: here ? { current: 'true' } : {},
  });
  const destroy = button(text.sessions.destroy, () => {
    const lost = text.sessions.destroyLoss(summary.time_s.toFixed(1));
    void ask(text.sessions.destroyQuestion(summary.session), lost, text.sessions.destroy).then((sure) => {
      if (sure) void attempt(problem, () => control.destroy(summary.session), destroy);
    });
  });
  destroy.setAttribute('aria-label', text.sessions.destroyLabel(summary.session));
  destroy.disabled = !control.model.mayOperate;
  return element('li', { class: here ? 'session here' : 'session' }, join, element('small', {}, details), destroy);
}

/** A session of another daemon. The link loads the page again, because a connection reaches only one daemon. */
function rowElsewhere(summary: SessionSummary): HTMLElement {
  const details = detailsOf(summary);
  const link = element('a', { class: 'session-name', title: text.sessions.watchElsewhere(summary.session) }, summary.session);
  link.href = `?session=${encodeURIComponent(summary.session)}`;
  return element('li', { class: 'session' }, link, element('small', {}, details));
}

/** The form for a new session, with the most useful members of the scene. */
function createForm(control: Control, problem: HTMLElement): HTMLElement {
  const { model, link } = control;
  const scene = element('select', { name: 'scene' });
  const name = nameInput({ name: 'name', maxLength: 40, placeholder: text.sessions.automatic });
  const iterations = element('input', { type: 'number', name: 'iterations', min: '1', max: '1000', step: '1' });
  const step = element('input', { type: 'number', name: 'step', min: '1', max: '33.3', step: 'any' });
  const gravity = element('input', { type: 'number', name: 'gravity', min: '-100', max: '100', step: 'any' });
  const seed = element('input', { type: 'number', name: 'seed', min: '0', step: '1' });
  const about = element('p', { class: 'about' });
  const unread = problemPlace(); // separate, because the page also loads scenes by itself, which must not hide another problem
  const submit = element('button', { type: 'submit' }, text.sessions.create);
  let definition: Scene | null = null;
  const load = async (): Promise<void> => {
    about.textContent = model.scenes.find((other) => other.name === scene.value)?.description ?? '';
    definition = (await link.call('scene.get', { scene: scene.value })).definition;
    iterations.value = String(definition.iterations ?? 10);
    step.value = (1000 * (definition.step_s ?? 1 / 60)).toFixed(2);
    gravity.value = String(definition.gravity_m_s2?.[2] ?? -9.81);
    seed.value = String(definition.seed ?? 0);
  };
  scene.addEventListener('change', () => void attempt(unread, load));
  const fill = (): void => {
    if (scene.options.length === model.scenes.length) return;
    scene.replaceChildren(...model.scenes.map((other) => element('option', { value: other.name }, other.name)));
    if (model.scenes.length > 0) void attempt(unread, load);
  };
  model.on('sessions', fill);
  model.on('link', () => (submit.disabled = !model.mayOperate));
  const form = element(
    'form',
    { class: 'form' },
    field(text.sessions.scene, scene),
    unread,
    about,
    field(text.sessions.name, name),
    field(text.sessions.iterations, iterations, '', text.sessions.iterationsTitle),
    field(text.sessions.step, step, 'ms', text.sessions.stepTitle),
    field(text.sessions.gravity, gravity, 'm/s²', text.sessions.gravityTitle),
    field(text.sessions.seed, seed, '', text.sessions.seedTitle),
    submit,
  );
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    void attempt(problem, () => control.create(request(definition, { scene, name, iterations, step, gravity, seed })), submit);
  });
  return element('details', { class: 'section' }, element('summary', {}, text.sessions.newSession), form);
}

interface CreateFields {
  scene: HTMLSelectElement;
  name: HTMLInputElement;
  iterations: HTMLInputElement;
  step: HTMLInputElement;
  gravity: HTMLInputElement;
  seed: HTMLInputElement;
}

/** Returns the request: the name of the scene if no member was changed, else the whole scene. */
function request(definition: Scene | null, fields: CreateFields): { scene?: string; definition?: Scene; name?: string } {
  const name = fields.name.value === '' ? {} : { name: fields.name.value };
  if (!definition) return { scene: fields.scene.value, ...name };
  const changed: Scene = {
    ...definition,
    iterations: fields.iterations.valueAsNumber,
    step_s: fields.step.valueAsNumber / 1000,
    gravity_m_s2: [definition.gravity_m_s2?.[0] ?? 0, definition.gravity_m_s2?.[1] ?? 0, fields.gravity.valueAsNumber],
    seed: fields.seed.valueAsNumber,
  };
  const sameStep = Math.abs((changed.step_s ?? 0) - (definition.step_s ?? 1 / 60)) < 1e-5;
  if (sameStep) changed.step_s = definition.step_s ?? 1 / 60;
  const same = JSON.stringify(changed) === JSON.stringify(definition);
  return same ? { scene: fields.scene.value, ...name } : { definition: changed, ...name };
}

function forkAndFiles(control: Control, problem: HTMLElement): HTMLElement {
  const { model } = control;
  const name = nameInput({ name: 'fork', maxLength: 40, placeholder: text.sessions.forkName });
  name.setAttribute('aria-label', text.sessions.forkNameLabel);
  const fork = button(text.sessions.fork, () => void attempt(problem, () => control.fork(name.value), fork), { id: 'fork', title: text.sessions.forkTitle });
  const exported = (format: 'vtu' | 'obj'): HTMLButtonElement => {
    const press = button(text.sessions.saveAs(format), () => void attempt(problem, () => control.call('session.export', { format }), press));
    return press;
  };
  const log = button(text.sessions.saveLog, () => void attempt(problem, () => control.call('session.log', {}), log));
  const buttons = [fork, exported('vtu'), exported('obj'), log];
  const refresh = (): void => {
    for (const one of buttons) one.disabled = model.joined === null || model.link.state !== 'online';
    fork.disabled ||= !model.mayOperate;
  };
  model.on('joined', refresh);
  model.on('link', refresh);
  refresh();
  return element('div', { class: 'buttons' }, name, ...buttons);
}

export function sessionsPanel(control: Control, link: Link, reveal: () => void): Panel {
  const { model } = control;
  const problem = problemPlace();
  const list = element('ul', { class: 'sessions', aria: { label: text.sessions.list } });
  const stale = problemPlace(); // separate, because the page refreshes the list by itself
  const about = element('p', { class: 'about' });
  const show = (): void => {
    list.replaceChildren(
      ...model.sessions.map((summary) => row(control, summary, problem)),
      ...model.elsewhere.map(rowElsewhere),
      ...model.silent.map((label) => element('li', {}, text.sessions.silent(label))),
    );
    if (list.childElementCount === 0) list.replaceChildren(element('li', {}, text.sessions.empty));
  };
  model.on('sessions', show);
  model.on('link', show);
  model.on('joined', (joined) => {
    const description = joined?.description;
    about.textContent = description
      ? text.sessions.about(description.description, description.summary.vertex_count, description.triangle_count, description.tetrahedron_count, description.link_count)
      : '';
  });
  const body = element(
    'div',
    {},
    problem,
    element('div', {}, stale, list),
    about,
    forkAndFiles(control, problem),
    snapshotSection(control),
    createForm(control, problem),
    uploadForm(control, link, reveal),
  );
  let visible = true;
  setInterval(() => {
    if (!visible || document.hidden || model.link.state !== 'online' || list.contains(document.activeElement)) return;
    void attempt(stale, async () => model.setSessions((await link.call('session.list', {})).sessions));
  }, REFRESH_MS);
  return { id: 'sessions', title: text.sessions.title, body, shown: (now) => (visible = now) };
}

export function saveReceived(name: string, mediaType: string, bytes: Uint8Array<ArrayBuffer>): void {
  save(name, new Blob([bytes], { type: mediaType }));
}
