// SPDX-License-Identifier: GPL-3.0-or-later
// Past views: while the timeline is held, the picture shows that time, read-only. A sign over the picture says so. It shows
// the progress of loading, and has a button to return.
import type { Control } from '../model/control';
import { errorWords } from '../model/sentences';
import { RpcError } from '../wire/connection';
import { button, byId, element } from './dom';

const SETTLED_MS = 250; // time without motion of the timeline after which the view is requested

const STAGE_WORDS = { building: 'preparing a second copy of the tissue', reading: 'reading the stored state', restoring: 'restoring the stored state', replaying: 'replaying the commands' };

export function showPast(control: Control): void {
  const { model } = control;
  const place = byId('past');
  const words = element('p');
  const bar = element('progress', { max: 1, aria: { label: 'Loading the past view' } });
  place.append(words, bar, button('Return to live', () => model.hold(null), { id: 'live' }));
  let timer: ReturnType<typeof setTimeout> | undefined;
  let wanted: number | null = null;

  const at = (tick: number): string => `t = ${(tick * (model.summary?.step_s ?? 1 / 60)).toFixed(2)} s`;
  const say = (text: string, going: boolean): void => {
    if (words.textContent !== text) words.textContent = text;
    bar.hidden = !going;
    if (!going) bar.removeAttribute('value');
  };
  const there = (): boolean => wanted !== null && model.frame?.past?.tick === wanted;
  const tell = (): void => {
    if (wanted !== null && there()) say(`You see the past at ${at(wanted)}. The session continues.`, false);
  };
  const ask = async (tick: number): Promise<void> => {
    try {
      await control.lookAt(tick);
    } catch (error) {
      if (tick !== wanted) return; // replaced by another request
      const later = error instanceof RpcError && error.status === 'bad_state';
      say(`${at(tick)} cannot be shown${later ? ' now' : ''}. ${errorWords(error)}`, false);
    }
  };
  const look = (tick: number | null): void => {
    clearTimeout(timer);
    wanted = tick;
    place.hidden = tick === null;
    if (tick === null) {
      control.lookAtPresent();
      return;
    }
    say(`Loading ${at(tick)}…`, true);
    timer = setTimeout(() => void ask(tick), SETTLED_MS);
  };

  model.on('held', look);
  model.on('frame', tell);
  model.on('looking', ({ tick, stage, from_tick: from, at_tick: now }) => {
    if (tick !== wanted || there()) return;
    say(`Loading ${at(tick)}: ${STAGE_WORDS[stage]}…`, true);
    if (stage === 'replaying' && tick > from) bar.value = (now - from) / (tick - from);
    else bar.removeAttribute('value');
  });
  // After joining again (for other channels, or after a lost connection) the stream shows the newest state.
  model.on('joined', (joined) => {
    if (joined && wanted !== null) look(wanted);
  });
}
