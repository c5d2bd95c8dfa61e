// SPDX-License-Identifier: GPL-3.0-or-later
// Past views: while the timeline is held, the picture shows that time, read-only. A sign over the picture says so. It shows
// the progress of loading, and has a button to return.
import type { Control } from '../model/control';
import { errorWords } from '../model/sentences';
import { text } from '../text/text';
import { RpcError } from '../wire/connection';
import { button, byId, element } from './dom';

const SETTLED_MS = 250; // time without motion of the timeline after which the view is requested

export function showPast(control: Control): void {
  const { model } = control;
  const place = byId('past');
  const words = element('p');
  const bar = element('progress', { max: 1, aria: { label: text.past.loadingBar } });
  place.append(words, bar, button(text.past.live, () => model.hold(null), { id: 'live' }));
  let timer: ReturnType<typeof setTimeout> | undefined;
  let wanted: number | null = null;

  const at = (tick: number): string => text.past.at((tick * (model.summary?.step_s ?? 1 / 60)).toFixed(2));
  const say = (sentence: string, going: boolean): void => {
    if (words.textContent !== sentence) words.textContent = sentence;
    bar.hidden = !going;
    if (!going) bar.removeAttribute('value');
  };
  const there = (): boolean => wanted !== null && model.frame?.past?.tick === wanted;
  const tell = (): void => {
    if (wanted !== null && there()) say(text.past.seen(at(wanted)), false);
  };
  const ask = async (tick: number): Promise<void> => {
    try {
      await control.lookAt(tick);
    } catch (error) {
      if (tick !== wanted) return; // replaced by another request
      const later = error instanceof RpcError && error.status === 'bad_state';
      say((later ? text.past.notShownNow : text.past.notShown)(at(tick), errorWords(error)), false);
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
    say(text.past.loading(at(tick)), true);
    timer = setTimeout(() => void ask(tick), SETTLED_MS);
  };

  model.on('held', look);
  model.on('frame', tell);
  model.on('looking', ({ tick, stage, from_tick: from, at_tick: now }) => {
    if (tick !== wanted || there()) return;
    say(text.past.loadingStage(at(tick), text.past.stages[stage]), true);
    if (stage === 'replaying' && tick > from) bar.value = (now - from) / (tick - from);
    else bar.removeAttribute('value');
  });
  // After joining again (for other channels, or after a lost connection) the stream shows the newest state.
  model.on('joined', (joined) => {
    if (joined && wanted !== null) look(wanted);
  });
}
