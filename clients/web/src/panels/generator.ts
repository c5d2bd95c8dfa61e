// SPDX-License-Identifier: GPL-3.0-or-later
// In scenes with energy `tissue`: a form for the instrument and mode of the tool in hand, and the power of its generator.
import type { Control } from '../model/control';
import { becoming, instrumentOf, modeNamed } from '../model/instruments';
import type { Instrument, InstrumentMode } from '../wire/messages.gen';
import { text } from '../text/text';
import { attempt, element, field, problemPlace } from './dom';

const words = (name: string): string => name.replaceAll('-', ' ');
const named = (name: string): string => words(name.charAt(0).toUpperCase() + name.slice(1));

function offer(select: HTMLSelectElement, names: readonly string[], chosen: string): void {
  select.replaceChildren(...names.map((name) => element('option', { value: name }, words(name))));
  select.value = names.includes(chosen) ? chosen : (names[0] ?? '');
}

export function generatorForm(control: Control): HTMLElement {
  const { model } = control;
  const problem = problemPlace();
  const instrument = element('select', { name: 'profile' });
  const mode = element('select', { name: 'mode' });
  const power = element('input', { type: 'number', name: 'power_w', step: 'any' });
  const about = element('p', { class: 'about' });
  const apply = element('button', { type: 'submit' }, text.generator.set);
  const form = element('form', { class: 'form' }, element('h2', {}, text.generator.title), field(text.generator.instrument, instrument), field(text.generator.mode, mode), field(text.generator.power, power, 'W'), about, element('div', { class: 'buttons' }, apply), problem);
  const chosen = (): Instrument | undefined => model.instruments.find(({ name }) => name === instrument.value);
  const chosenMode = (): InstrumentMode | undefined => {
    const profile = chosen();
    return profile && modeNamed(profile, mode.value);
  };
  const showMode = (watts?: number): void => {
    const now = chosenMode();
    if (!now) return;
    power.min = String(now.power_least_w);
    power.max = String(now.power_most_w);
    power.value = String(watts ?? now.power_w);
    about.textContent = text.generator.about(chosen()?.description ?? '', named(now.mode), now.description);
  };
  const showModes = (wanted: string): void => offer(mode, (chosen()?.modes ?? []).map((one) => one.mode), wanted);
  instrument.addEventListener('change', () => {
    showModes(mode.value);
    showMode();
  });
  mode.addEventListener('change', () => showMode());
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    void attempt(problem, () => control.becomeInstrument(becoming(model.selectedTool ?? '', instrument.value, mode.value, power.valueAsNumber)), apply);
  });
  let shown = '';
  model.on('tools', () => {
    const { tool } = model;
    form.hidden = !tool || model.instruments.length === 0 || model.joined?.description.definition.energy !== 'tissue';
    apply.disabled = !model.driving;
    if (!tool || form.hidden) return;
    const next = JSON.stringify([tool.name, tool.shape, tool.power_w, tool.peak_v, tool.crest_factor]);
    if (next === shown) return; // a choice that was not applied yet stays
    shown = next;
    const is = instrumentOf(model.instruments, tool);
    offer(instrument, model.instruments.map(({ name }) => name), is?.instrument ?? '');
    showModes(is?.mode ?? '');
    showMode(is ? tool.power_w : undefined);
  });
  form.hidden = true;
  return form;
}
