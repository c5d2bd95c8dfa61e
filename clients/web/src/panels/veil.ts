// SPDX-License-Identifier: GPL-3.0-or-later
// A veil over a picture that is not up to date: without WebGL, without a connection, while a session is built, rewound or
// restored, or if the daemon sends nothing. It shows a text, and a progress bar while something is under way.
import type { Control } from '../model/control';
import type { Viewport } from '../scene/viewport';
import { text } from '../text/text';
import { button, byId, element } from './dom';

const LOOK_MS = 250;
const SILENT_MS = 2000; // without frames of a running session
const QUICK_MS = 300; // shorter work is not shown

interface Veil {
  words: string;
  /** whether something is under way */
  busy: boolean;
  action?: { words: string; press: () => void };
}

const RELOAD = { words: text.veil.reload, press: (): void => window.location.reload() };

function graphics(viewport: Viewport): Veil | null {
  switch (viewport.graphics) {
    case 'none':
      return { words: text.veil.noGraphics, busy: false };
    case 'lost':
      return { words: text.veil.lostGraphics, busy: true, action: RELOAD };
    case 'ready':
      return null;
  }
}

function connection({ model }: Control, enterToken: () => void): Veil | null {
  const { link } = model;
  if (link.state === 'connecting') return { words: text.veil.connecting, busy: true };
  if (link.state === 'lost') return { words: text.veil.lost(link.words), busy: true };
  if (link.state !== 'refused') return null;
  if (link.status === 'unauthorized') return { words: text.veil.tokenNeeded, busy: false, action: { words: text.veil.enterToken, press: enterToken } };
  return { words: link.words, busy: false, action: RELOAD };
}

export function showVeil(control: Control, viewport: Viewport, enterToken: () => void): void {
  const { model } = control;
  const place = byId('veil');
  const words = element('p');
  const bar = element('progress', { aria: { label: text.veil.progress } });
  const action = button('', () => undefined);
  place.append(element('div', { class: 'veil-card' }, words, bar, action));
  let framedAt = performance.now();
  let joinedAt = framedAt;
  let everShown = false; // an empty picture always has a veil
  // A hidden page draws nothing.
  const shows = (session: string): boolean => viewport.shown.session === session || document.hidden;
  let busySince: number | null = null;

  const waiting = (): Veil | null => {
    const now = performance.now();
    if (control.busy.length === 0) busySince = null;
    else busySince ??= now;
    if (busySince !== null && now - busySince >= QUICK_MS) return { words: text.veil.busy(control.busy[0]), busy: true };
    if (model.link.state !== 'online') return null;
    if (model.session === null) return { words: text.veil.noSession, busy: false };
    if (model.summary?.state === 'starting') return { words: text.veil.starting(model.session), busy: true };
    if (model.frame?.session !== model.session || !shows(model.session)) {
      const quick = everShown && now - joinedAt < QUICK_MS;
      return quick ? null : { words: text.veil.opening(model.session), busy: true };
    }
    everShown = true;
    if (model.frame.paused || model.frame.faulted || document.hidden || now - framedAt < SILENT_MS) return null;
    return { words: text.veil.silent(((now - framedAt) / 1000).toFixed(0)), busy: true };
  };
  const show = (): void => {
    const veil = graphics(viewport) ?? connection(control, enterToken) ?? waiting();
    place.hidden = veil === null;
    if (!veil) return;
    if (words.textContent !== veil.words) words.textContent = veil.words;
    bar.hidden = !veil.busy;
    action.hidden = veil.action === undefined;
    if (!veil.action) return;
    action.textContent = veil.action.words;
    action.onclick = veil.action.press;
  };
  model.on('frame', () => (framedAt = performance.now()));
  model.on('joined', () => (framedAt = joinedAt = performance.now()));
  model.on('link', show);
  show();
  setInterval(show, LOOK_MS);
}
