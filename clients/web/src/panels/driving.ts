// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the driver of the chosen tool, with buttons to take the tool, ask for it and release it.
import type { Control } from '../model/control';
import { nameOf } from '../model/person';
import { ask } from './ask';
import { attempt, button, element } from './dom';

function driverWords(control: Control, tool: string): string {
  const driver = control.model.drivers.get(tool);
  if (!driver || driver.client === 0) return control.model.mayOperate ? `The ${tool} is free. Use it to become its driver.` : `The ${tool} is free. Your access allows you to watch only.`;
  if (driver.client === control.model.hello?.client) return `You use the ${tool}.`;
  return `${nameOf(driver)} uses the ${tool}.`;
}

export function drivingButtons(control: Control, problem: HTMLElement): { place: HTMLElement; refresh(): void } {
  const { model } = control;
  const said = element('p', { class: 'about', aria: { role: 'status' } });
  const chosen = (): string => model.selectedTool ?? '';
  const take = button('Take the tool', () => {
    const driver = model.drivers.get(chosen());
    const asked = driver && driver.client !== 0 ? ask(`Take the ${chosen()} from ${nameOf(driver)}?`, `Its energy goes off, and ${nameOf(driver)} can no longer move the tool.`, 'Take it') : Promise.resolve(true);
    void asked.then((sure) => {
      if (sure) void attempt(problem, () => control.takeOver(chosen()), take);
    });
  }, { class: 'take' });
  const request = button('Ask its driver', () => {
    void attempt(problem, () => control.ask(chosen()), request).then((done) => {
      if (done !== null) said.textContent = 'The driver was asked for the tool.';
    });
  });
  const give = button('Release the tool', () => void attempt(problem, () => control.handOver(chosen()), give), { class: 'give' });
  const refresh = (): void => {
    const driver = model.drivers.get(chosen());
    const others = driver !== undefined && driver.client !== 0 && !model.driving;
    said.textContent = model.tool ? driverWords(control, model.tool.name) : 'This session has no tools.';
    take.hidden = model.driving || (others && model.hello?.role !== 'admin');
    request.hidden = !others;
    give.hidden = !model.driving;
    for (const one of [take, request, give]) one.disabled = !model.mayOperate || !model.tool;
  };
  return { place: element('div', {}, said, element('div', { class: 'buttons' }, take, request, give)), refresh };
}
