// SPDX-License-Identifier: GPL-3.0-or-later
// The events of a timeline as a list for users. Successive cuts of one tool are one line.
import { text } from '../text/text';
import type { TimelineEvent } from '../wire/messages.gen';

export const EVENT_WORDS: Partial<Record<TimelineEvent['kind'], string>> = text.moments.events;
/** Kinds of events whose detail is the name of a layer or vessel. */
const NAMED: readonly TimelineEvent['kind'][] = ['inverted', 'bleeding', 'bleeding_stopped', 'sealed'];
const GOES_ON: readonly TimelineEvent['kind'][] = ['cut', 'tear'];

export interface Moment {
  /** tick of the first of its events */
  tick: number;
  words: string;
}

/** "3.20 s: energy on, hook" and "3.50 to 7.90 s: cut, hook", the newest first. */
export function momentsOf(events: readonly TimelineEvent[], seconds: (tick: number) => string): Moment[] {
  const found: { first: TimelineEvent; last: TimelineEvent }[] = [];
  for (const event of events) {
    const before = found.at(-1);
    const goesOn = before !== undefined && GOES_ON.includes(event.kind) && before.first.kind === event.kind && before.first.tool === event.tool;
    if (goesOn) before.last = event;
    else found.push({ first: event, last: event });
  }
  return found.reverse().map(({ first: { kind, tick, tool, detail }, last }) => {
    const when = last.tick === tick ? seconds(tick) : text.moments.span(seconds(tick).replace(/ s$/, ''), seconds(last.tick));
    const about = tool || (NAMED.includes(kind) ? detail : undefined);
    return { tick, words: `${when}: ${EVENT_WORDS[kind] ?? kind}${about ? `, ${about}` : ''}` };
  });
}
