// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the driver of the chosen tool, with buttons to take the tool, ask for it and release it.
import type { Control } from '../model/control';
import { nameOf } from '../model/person';
import { text } from '../text/text';
import { ask } from './ask';
import { attempt, button, element } from './dom';

function driverWords(control: Control, tool: string): string {
  const driver = control.model.drivers.get(tool);
  if (!driver || driver.client === 0) return control.model.mayOperate ? text.driving.free(tool) : text.driving.freeToWatch(tool);
  if (driver.client === control.model.hello?.client) return text.driving.own(tool);
  return text.driving.other(nameOf(driver), tool);
}

export function drivingButtons(control: Control, problem: HTMLElement): { place: HTMLElement; refresh(): void } {
  const { model } = control;
  const said = element('p', { class: 'about', aria: { role: 'status' } });
  const chosen = (): string => model.selectedTool ?? '';
  const take = button(text.driving.take, () => {
    const driver = model.drivers.get(chosen());
    const asked = driver && driver.client !== 0 ? ask(text.driving.takeQuestion(chosen(), nameOf(driver)), text.driving.takeLoss(nameOf(driver)), text.driving.takeIt) : Promise.resolve(true);
    void asked.then((sure) => {
      if (sure) void attempt(problem, () => control.takeOver(chosen()), take);
    });
  }, { class: 'take' });
  const request = button(text.driving.ask, () => {
    void attempt(problem, () => control.ask(chosen()), request).then((done) => {
      if (done !== null) said.textContent = text.driving.asked;
    });
  });
  const give = button(text.driving.release, () => void attempt(problem, () => control.handOver(chosen()), give), { class: 'give' });
  const refresh = (): void => {
    const driver = model.drivers.get(chosen());
    const others = driver !== undefined && driver.client !== 0 && !model.driving;
    said.textContent = model.tool ? driverWords(control, model.tool.name) : text.driving.noTools;
    take.hidden = model.driving || (others && model.hello?.role !== 'admin');
    request.hidden = !others;
    give.hidden = !model.driving;
    for (const one of [take, request, give]) one.disabled = !model.mayOperate || !model.tool;
  };
  return { place: element('div', {}, said, element('div', { class: 'buttons' }, take, request, give)), refresh };
}
