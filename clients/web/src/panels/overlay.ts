// SPDX-License-Identifier: GPL-3.0-or-later
// The elements over the picture: connection, help, messages, requests of other users, and a text for screen readers.
import { KEY_HELP } from '../hands/keys';
import { nameOf } from '../model/person';
import type { Control } from '../model/control';
import type { LinkState } from '../wire/connection';
import type { Notice } from '../model/model';
import { attempt, button, byId, element, problemPlace } from './dom';

const NOTICE_MS = 9000;
const NOTICES_MAX = 4;

function linkWords(link: LinkState): string {
  switch (link.state) {
    case 'connecting':
      return 'Connecting…';
    case 'online':
      return `${link.hello.server} · ${link.hello.role}`;
    case 'lost':
      return `No connection: ${link.words}. Trying again.`;
    case 'refused':
      return link.status === 'unauthorized' ? 'An access token is needed' : link.words;
  }
}

export function showLink(control: Control): void {
  const { model } = control;
  const place = byId('link');
  const show = (): void => {
    place.textContent = linkWords(model.link);
    place.className = `link ${model.link.state}`;
  };
  model.on('link', show);
  model.on('joined', (joined) => (byId('where').textContent = joined ? joined.description.summary.session : 'no session'));
  show();
}

const MOUSE_HINT = [
  'Move the mouse over the tissue to move the tool. Press to cut.',
  'Go slowly. Tissue needs a few seconds of heat before it parts.',
  'Drag beside the tissue to turn the view. Use the timeline below to view an earlier time.',
];
const FINGER_HINT = [
  'Touch the tissue to cut. Choose Move to move the tool without heat.',
  'Go slowly. Tissue needs a few seconds of heat before it parts.',
  'Use two fingers to turn the view. Use the timeline to view an earlier time.',
];

/** Adds the button Help, which lists all controls. The cue on the tissue is enough to begin. */
export function showHelp(): void {
  const hint = byId('hint');
  const open = (): void => {
    hint.replaceChildren(
      ...(window.matchMedia('(pointer: coarse)').matches ? FINGER_HINT : MOUSE_HINT).map((words) => element('p', {}, words)),
      element('details', {}, element('summary', {}, 'All keys'), element('dl', {}, ...KEY_HELP.flatMap(([key, what]) => [element('dt', {}, key), element('dd', {}, what)]))),
      element('p', {}, element('a', { href: 'manual/', target: '_blank', rel: 'noopener' }, 'Manual')), // the daemon's own
      button('Understood', () => (hint.hidden = true)),
    );
    hint.hidden = !hint.hidden;
  };
  document.querySelector('.bar')?.append(button('Help', open, { id: 'help' }));
}

export function showNotices(control: Control): void {
  const place = byId('notices');
  control.model.on('notice', ({ kind, words }: Notice) => {
    const same = [...place.children].find((child) => child.firstChild?.textContent === words);
    same?.remove();
    const line = element('div', { class: `notice ${kind}` }, element('span', {}, words));
    line.append(button('×', () => line.remove(), { aria: { label: 'Dismiss' } }));
    place.append(line);
    while (place.children.length > NOTICES_MAX) place.firstElementChild?.remove();
    setTimeout(() => line.remove(), NOTICE_MS);
  });
  control.model.on('takeover', (asked) => {
    place.querySelector('.asked')?.remove();
    if (!asked) return;
    const problem = problemPlace();
    const done = (): void => control.model.setTakeover(null);
    const give = button('Hand over', () => {
      void attempt(problem, () => control.handOver(asked.tool, asked.client), give).then((given) => given === null || done());
    });
    const words = `${nameOf(asked)} asks for the ${asked.tool}.`;
    place.append(element('div', { class: 'notice info asked' }, element('span', {}, words), give, button('Keep it', done), problem));
  });
}

const READING_MS = 1500;

/** Updates a text for users who cannot see the picture: the remaining faces of each layer, and the position of the tool. */
export function showReading(control: Control): void {
  const { model } = control;
  const place = byId('reading');
  setInterval(() => {
    const { frame, toolState: tool } = model;
    if (!frame) return;
    const layers = Object.entries(frame.drawnFaces).map(([name, count]) => `${name} ${count} faces`);
    const at = tool ? `${tool.name} at ${tool.positionM.map((v) => (1000 * v).toFixed(1)).join(', ')} mm` : '';
    place.textContent = `${layers.join(', ')}. ${at}`;
  }, READING_MS);
}
