// SPDX-License-Identifier: GPL-3.0-or-later
// Panels behind tabs, with the usual keyboard pattern of tab lists.
import { byId, element } from './dom';

export interface Panel {
  id: string;
  title: string;
  body: HTMLElement;
  /** called when the panel is shown or hidden */
  shown?: (visible: boolean) => void;
}

/** Returns a function that shows or hides all tabs, and a function that opens one. */
export function makeTabs(panels: readonly Panel[]): { show(visible: boolean): void; open(id: string): void } {
  const list = byId('tabs');
  const place = byId('panels');
  const tabs = panels.map((panel) => {
    panel.body.id = `panel-${panel.id}`;
    panel.body.classList.add('panel');
    panel.body.setAttribute('role', 'tabpanel');
    panel.body.setAttribute('aria-labelledby', `tab-${panel.id}`);
    place.append(panel.body);
    return element('button', { type: 'button', id: `tab-${panel.id}`, aria: { role: 'tab', controls: `panel-${panel.id}` } }, panel.title);
  });
  let shown = 0;
  let all = false;
  const show = (chosen: number, focus: boolean): void => {
    shown = chosen;
    panels.forEach((panel, i) => {
      tabs[i].setAttribute('aria-selected', String(i === chosen));
      tabs[i].tabIndex = i === chosen ? 0 : -1;
      panel.body.hidden = i !== chosen;
      panel.shown?.(all && i === chosen);
    });
    if (focus) tabs[chosen].focus();
  };
  tabs.forEach((tab, i) => {
    tab.addEventListener('click', () => show(i, false));
    tab.addEventListener('keydown', (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (step !== undefined) show((i + step + tabs.length) % tabs.length, true);
      else if (event.key === 'Home') show(0, true);
      else if (event.key === 'End') show(tabs.length - 1, true);
      else return;
      event.preventDefault();
    });
    list.append(tab);
  });
  show(0, false);
  return {
    show(visible) {
      all = visible;
      list.hidden = place.hidden = !visible;
      show(shown, false);
    },
    open(id) {
      show(panels.findIndex((panel) => panel.id === id), false);
    },
  };
}
