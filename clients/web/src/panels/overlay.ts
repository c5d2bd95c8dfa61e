// SPDX-License-Identifier: GPL-3.0-or-later
// The elements over the picture: connection, help, messages, requests of other users, and a text for screen readers.
import { KEY_HELP } from '../hands/keys';
import { nameOf } from '../model/person';
import type { Control } from '../model/control';
import type { LinkState } from '../wire/connection';
import type { Notice } from '../model/model';
import { text } from '../text/text';
import { attempt, button, byId, element, problemPlace } from './dom';

const NOTICE_MS = 9000;
const NOTICES_MAX = 4;

function linkWords(link: LinkState): string {
  switch (link.state) {
    case 'connecting':
      return text.overlay.connecting;
    case 'online':
      return text.overlay.online(link.hello.server, text.overlay.roles[link.hello.role]);
    case 'lost':
      return text.overlay.lost(link.words);
    case 'refused':
      return link.status === 'unauthorized' ? text.overlay.tokenNeeded : link.words;
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
  model.on('joined', (joined) => (byId('where').textContent = joined ? joined.description.summary.session : text.overlay.noSession));
  show();
}

/** Adds the button Help, which lists all controls. The cue on the tissue is enough to begin. */
export function showHelp(): void {
  const hint = byId('hint');
  const open = (): void => {
    hint.replaceChildren(
      ...(window.matchMedia('(pointer: coarse)').matches ? text.overlay.fingerHint : text.overlay.mouseHint).map((words) => element('p', {}, words)),
      element('details', {}, element('summary', {}, text.overlay.allKeys), element('dl', {}, ...KEY_HELP.flatMap(([key, what]) => [element('dt', {}, key), element('dd', {}, what)]))),
      element('p', {}, element('a', { href: 'manual/', target: '_blank', rel: 'noopener' }, text.overlay.manual)), // the daemon's own
      button(text.overlay.understood, () => (hint.hidden = true)),
    );
    hint.hidden = !hint.hidden;
  };
  document.querySelector('.bar')?.append(button(text.overlay.help, open, { id: 'help' }));
}

export function showNotices(control: Control): void {
  const place = byId('notices');
  control.model.on('notice', ({ kind, words }: Notice) => {
    const same = [...place.children].find((child) => child.firstChild?.textContent === words);
    same?.remove();
    const line = element('div', { class: `notice ${kind}` }, element('span', {}, words));
    line.append(button('×', () => line.remove(), { aria: { label: text.overlay.dismiss } }));
    place.append(line);
    while (place.children.length > NOTICES_MAX) place.firstElementChild?.remove();
    setTimeout(() => line.remove(), NOTICE_MS);
  });
  control.model.on('takeover', (asked) => {
    place.querySelector('.asked')?.remove();
    if (!asked) return;
    const problem = problemPlace();
    const done = (): void => control.model.setTakeover(null);
    const give = button(text.overlay.handOver, () => {
      void attempt(problem, () => control.handOver(asked.tool, asked.client), give).then((given) => given === null || done());
    });
    const words = text.overlay.asks(nameOf(asked), asked.tool);
    place.append(element('div', { class: 'notice info asked' }, element('span', {}, words), give, button(text.overlay.keep, done), problem));
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
    const layers = Object.entries(frame.drawnFaces).map(([name, count]) => text.overlay.faces(name, count));
    const at = tool ? text.overlay.toolAt(tool.name, tool.positionM.map((v) => (1000 * v).toFixed(1)).join(', ')) : '';
    place.textContent = text.overlay.reading(layers.join(', '), at);
  }, READING_MS);
}
