// SPDX-License-Identifier: GPL-3.0-or-later
// The panel of tools: the tool in hand, its driver, its shape and sizes, and new tools.
import type { ToolHand } from '../hands/tool_hand';
import type { Control } from '../model/control';
import { hasHeat, hasJaws, type Shape } from '../model/tool_parts';
import { text } from '../text/text';
import { PARAMETERS, TOOL_SHAPES, type Tool } from '../wire/messages.gen';
import { ask } from './ask';
import { attempt, button, element, field, problemPlace, short } from './dom';
import { drivingButtons } from './driving';
import { generatorForm } from './generator';
import { nameInput } from './names';
import { parameterInputs } from './parameters';
import type { Panel } from './tabs';
import { vesselList } from './vessels';

const SHOWN = ['temperature_c', 'hot_radius_m', 'tip_length_m', 'shaft_radius_m', 'jaw_open_rad', 'max_speed_m_s', 'friction'];
const OF_JAWS = ['jaw_open_rad'];
const OF_HEAT = ['temperature_c', 'hot_radius_m'];
const LEAST_FORCE_N = 1e-4; // below it a hand feels nothing

function shapeSelect(): HTMLSelectElement {
  return element('select', { name: 'shape' }, ...TOOL_SHAPES.map((shape) => element('option', { value: shape }, text.tools.shapes[shape] ?? shape)));
}

function editForm(control: Control, problem: HTMLElement): { form: HTMLElement; refresh(): void } {
  const { model } = control;
  const shape = shapeSelect();
  const sizes = parameterInputs(PARAMETERS.tool.filter((parameter) => SHOWN.includes(parameter.name)));
  const apply = element('button', { type: 'submit' }, text.tools.apply);
  const remove = button(text.tools.remove, () => {
    const tool = model.selectedTool ?? '';
    void ask(text.tools.removeQuestion(tool), text.tools.removeLoss, text.tools.remove).then((sure) => {
      if (sure) void attempt(problem, () => control.removeTool(tool), remove);
    });
  });
  const form = element('form', { class: 'form' }, field(text.tools.shape, shape), ...sizes.fields, element('div', { class: 'buttons' }, apply, remove));
  const offer = (): void => {
    const wanted = shape.value as Shape;
    sizes.offer((name) => (OF_JAWS.includes(name) ? hasJaws(wanted) : !OF_HEAT.includes(name) || hasHeat(wanted)));
  };
  shape.addEventListener('change', offer);
  let shown: Tool | null = null;
  const forget = (): void => {
    shown = null;
    sizes.clear();
  };
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const work = async (): Promise<void> => {
      if (!model.tool) throw new Error(text.tools.chooseFirst);
      const wanted = { ...model.tool, ...sizes.read(), shape: shape.value as Shape };
      await control.configureTool(wanted);
      forget();
      refresh();
    };
    void attempt(problem, work, apply);
  });
  const refresh = (): void => {
    const { tool } = model;
    form.hidden = !tool;
    apply.disabled = remove.disabled = !model.driving;
    if (!tool) return;
    if (tool.name !== shown?.name) forget();
    if (tool.shape && tool.shape !== shown?.shape) shape.value = tool.shape;
    sizes.show({ ...tool });
    offer();
    shown = tool;
  };
  return { form, refresh };
}

function addForm(control: Control): HTMLElement {
  const { model } = control;
  const problem = problemPlace();
  const name = nameInput({ name: 'tool', required: true, maxLength: 48, value: 'grasper' });
  const shape = shapeSelect();
  shape.value = 'grasper';
  shape.addEventListener('change', () => (name.value = shape.value));
  const add = element('button', { type: 'submit' }, text.tools.add);
  const form = element('form', { class: 'form' }, field(text.tools.shape, shape), field(text.tools.name, name), add, problem);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    void attempt(problem, () => control.addTool({ name: name.value, shape: shape.value as Shape, position_m: [0.03, 0, 0.05] }), add);
  });
  model.on('tools', () => (add.disabled = !model.mayOperate || !model.joined));
  return element('details', { class: 'section' }, element('summary', {}, text.tools.addTitle), form);
}

export function toolsPanel(control: Control, hand: ToolHand): Panel {
  const { model } = control;
  const problem = problemPlace();
  const choose = element('select', { name: 'held', id: 'held' });
  choose.addEventListener('change', () => model.selectTool(choose.value));
  const guide = element(
    'select',
    { name: 'guide' },
    element('option', { value: 'surface' }, text.tools.guides.surface),
    element('option', { value: 'plane' }, text.tools.guides.plane),
  );
  guide.addEventListener('change', () => (hand.guide = guide.value === 'plane' ? 'plane' : 'surface'));
  const jaw = element('input', { type: 'range', min: '0', max: '1', step: '0.01', name: 'jaw' });
  jaw.addEventListener('input', () => hand.setJaw(jaw.valueAsNumber));
  const jawField = field(text.tools.jaws, jaw, '', text.tools.jawsTitle);
  const state = element('output', { class: 'state' });
  const driving = drivingButtons(control, problem);
  const edit = editForm(control, problem);
  model.on('tools', () => {
    choose.replaceChildren(...model.tools.map((tool) => element('option', { value: tool.name }, tool.name)));
    choose.value = model.selectedTool ?? '';
    jawField.hidden = !hand.jaws.usable;
    driving.refresh();
    edit.refresh();
  });
  model.on('frame', () => {
    const tool = model.toolState;
    if (!tool) return;
    const energy = tool.energized ? text.tools.energyOn : text.tools.energyOff[tool.energyOff];
    const force = Math.hypot(...tool.forceN);
    const pressed = tool.jawForceN < LEAST_FORCE_N ? '' : text.tools.pressed(short(tool.jawForceN, 2));
    const grasp = !tool.grasping ? '' : tool.graspedVertices === 0 ? text.tools.jawsEmpty : `${text.tools.holds(tool.graspedVertices)}${pressed}${tool.slipping ? text.tools.slipping : ''}`;
    const power = tool.deliveredW > 0 ? `${text.tools.power(short(tool.deliveredW, 2))}${tool.loadOhm > 0 ? text.tools.load(short(tool.loadOhm, 3)) : ''}` : '';
    const line = `${energy}${power}${grasp}; ${tool.tipTemperatureC.toFixed(0)} °C, ${force < LEAST_FORCE_N ? '0' : short(force, 2)} N, ${short(tool.energyJ, 3)} J`;
    if (state.value !== line) state.value = line;
  });
  const body = element('div', {}, problem, field(text.tools.inHand, choose), driving.place, state, vesselList(model), field(text.tools.moves, guide), jawField, generatorForm(control), edit.form, addForm(control));
  return { id: 'tools', title: text.tools.title, body };
}
