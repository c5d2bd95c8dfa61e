// SPDX-License-Identifier: GPL-3.0-or-later
// The panel for trainees: instrument, power, camera, and the own name. The time bar is at the foot of the page.
import type { ToolHand } from '../hands/tool_hand';
import type { Control } from '../model/control';
import { NAME_MAX, nameOf, ownName, setOwnName } from '../model/person';
import { hasHeat } from '../model/tool_parts';
import type { Viewport } from '../scene/viewport';
import { text } from '../text/text';
import { PARAMETERS } from '../wire/messages.gen';
import { cameraButtons } from './camera';
import { attempt, byId, element, field, problemPlace } from './dom';
import { drivingButtons } from './driving';
import { generatorForm } from './generator';
import { inviteButton } from './invite';
import { vesselList } from './vessels';

const POWER_LEAST_C = 60;
const POWER_MOST_C = 400; // tissue looks the same above this
const POWER_STEP_C = 10;

function instrument(control: Control, problem: HTMLElement): HTMLElement {
  const { model } = control;
  const choose = element('select', { name: 'instrument' });
  choose.addEventListener('change', () => model.selectTool(choose.value));
  const chosen = field(text.operate.inHand, choose);
  const driving = drivingButtons(control, problem);
  model.on('tools', () => {
    choose.replaceChildren(...model.tools.map(({ name }) => element('option', { value: name }, name)));
    choose.value = model.selectedTool ?? '';
    chosen.hidden = model.tools.length < 2;
    driving.refresh();
  });
  return element('section', { aria: { label: text.operate.instrument } }, element('h2', {}, text.operate.instrument), chosen, driving.place);
}

function power(control: Control, hand: ToolHand, problem: HTMLElement): HTMLElement {
  const { model } = control;
  const usual = PARAMETERS.tool.find(({ name }) => name === 'temperature_c')!.default;
  const slider = element('input', {
    type: 'range', name: 'power', min: String(POWER_LEAST_C), max: String(POWER_MOST_C), step: String(POWER_STEP_C), aria: { label: text.operate.powerSlider },
  });
  const shown = element('output', { class: 'now-power' });
  const tell = (): void => {
    shown.value = text.operate.tip(slider.value);
  };
  let held = false;
  slider.addEventListener('input', () => {
    held = true;
    tell();
  });
  slider.addEventListener('change', () => {
    held = false;
    const { tool } = model;
    if (tool) void attempt(problem, () => control.configureTool({ ...tool, temperature_c: slider.valueAsNumber }));
  });
  const section = element('section', { aria: { label: text.operate.power } }, element('h2', {}, text.operate.power), slider, shown);
  model.on('tools', () => {
    const { tool } = model;
    section.hidden = !tool || !hasHeat(tool.shape) || model.joined?.description.definition.energy === 'tissue'; // with a generator, the power is set in its form
    slider.disabled = !hand.driving;
    slider.title = hand.driving ? '' : text.operate.takeFirst;
    if (held || !tool) return;
    slider.value = String(tool.temperature_c ?? usual);
    tell();
  });
  return section;
}

/** This client, as the daemon knows it. */
export interface Self {
  token: () => string | undefined;
  rename: () => void;
}

function person(control: Control, self: Self): HTMLElement {
  const name = element('input', { name: 'person', value: ownName(), maxLength: NAME_MAX, autocomplete: 'off' });
  name.addEventListener('change', () => {
    setOwnName(name.value);
    name.value = ownName();
    self.rename();
  });
  const others = element('p', { class: 'about' });
  control.model.on('tools', () => {
    const named = [...control.model.drivers.values()].filter(({ client, tool }) => client !== 0 && !control.model.drives(tool));
    others.textContent = named.map((driver) => text.operate.driver(nameOf(driver), driver.tool)).join(' ');
  });
  return element('section', { aria: { label: text.operate.you } }, element('h2', {}, text.operate.you), field(text.operate.yourName, name, '', text.operate.yourNameTitle), others, element('div', { class: 'buttons' }, inviteButton(control.model, self.token)));
}

function session(control: Control): HTMLElement {
  const { model } = control;
  const choose = element('select', { name: 'session', aria: { label: text.operate.session } });
  choose.addEventListener('change', () => control.watch(choose.value));
  const section = element('section', { aria: { label: text.operate.session } }, element('h2', {}, text.operate.session), choose);
  model.on('sessions', (sessions) => {
    section.hidden = sessions.length < 2;
    choose.replaceChildren(...sessions.map(({ session: id }) => element('option', { value: id }, id)));
    choose.value = model.session ?? '';
  });
  section.hidden = true;
  return section;
}

export function operatePanel(control: Control, hand: ToolHand, viewport: Viewport, self: Self, more: readonly HTMLElement[]): void {
  const problem = problemPlace();
  byId('operate').append(problem, session(control), instrument(control, problem), power(control, hand, problem), generatorForm(control), vesselList(control.model), element('section', { aria: { label: text.operate.camera } }, element('h2', {}, text.operate.camera), cameraButtons(viewport)), person(control, self), ...more);
  control.model.emit('tools', undefined);
}
