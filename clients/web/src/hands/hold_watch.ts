// SPDX-License-Identifier: GPL-3.0-or-later
// Watches the page for everything that ends a hold, and reports it as an event of holds.ts. Presses are reported
// by what is pressed (pointer.ts, keys.ts, pedal.ts, gamepad.ts, space_mouse.ts, panels/handles.ts).
import { keyId, LATCH, pointerId, type FocusTarget, type HoldEvent, type Place } from './holds';

export interface Watched {
  readonly pressed: boolean;
  take(event: HoldEvent): void;
}

const PLACES: readonly Place[] = ['picture', 'energy', 'latch'];
/** Types of inputs into which no text is typed. */
const NOT_TYPED = new Set(['range', 'checkbox', 'radio', 'button', 'submit', 'reset', 'file', 'color']);

/** Returns whether keys write or choose something in this element. */
export function takesTyping(target: EventTarget | null): boolean {
  if (target instanceof HTMLInputElement) return !NOT_TYPED.has(target.type);
  return target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement || (target instanceof HTMLElement && target.isContentEditable);
}

/** Returns the part of the page that contains an element. The ids of the elements are the names of the parts. */
function placeOf(target: EventTarget | null): Place | null {
  return (target instanceof Element && PLACES.find((place) => target.closest(`#${place}`))) || null;
}

function focusTarget(target: EventTarget | null): FocusTarget {
  return takesTyping(target) ? 'field' : (placeOf(target) ?? 'other');
}

function watchPointers(watched: Watched): void {
  const early = { capture: true };
  window.addEventListener('pointerdown', (event) => {
    const place = placeOf(event.target);
    if (place) watched.take({ type: 'down', id: pointerId(event.pointerId), place, kind: event.pointerType, first: event.isPrimary });
  }, early);
  // While one button is down, pressing and releasing others gives no `pointerup` but moves with other `buttons`.
  for (const type of ['pointermove', 'pointerup'] as const)
    window.addEventListener(type, ({ pointerId: id, buttons }) => watched.take({ type: 'buttons', id: pointerId(id), buttons: type === 'pointerup' ? 0 : buttons }), early);
  for (const type of ['pointercancel', 'lostpointercapture'] as const)
    window.addEventListener(type, ({ pointerId: id }) => watched.take({ type: 'release', id: pointerId(id), why: 'cancelled' }), early);
  // A menu hides the release of a button over it. A long press of a finger also opens a menu, which the page prevents.
  window.addEventListener('contextmenu', (event) => {
    const byFinger = (event as Partial<PointerEvent>).pointerType === 'touch' && placeOf(event.target) !== null;
    if (!byFinger) watched.take({ type: 'leave', why: 'menu' });
  }, early);
}

function watchKeys(watched: Watched): void {
  const early = { capture: true };
  window.addEventListener('keyup', ({ code }) => watched.take({ type: 'release', id: keyId(code) }), early);
  window.addEventListener('keydown', ({ code }) => code === 'Escape' && watched.take({ type: 'release', id: LATCH }), early);
  window.addEventListener('focusin', ({ target }) => watched.take({ type: 'focus', to: focusTarget(target) }));
  window.addEventListener('focusout', ({ relatedTarget }) => watched.take({ type: 'focus', to: focusTarget(relatedTarget) }));
}

function watchPage(watched: Watched): void {
  window.addEventListener('blur', () => watched.take({ type: 'leave', why: 'blur' }));
  document.addEventListener('visibilitychange', () => document.hidden && watched.take({ type: 'leave', why: 'hidden' }));
  window.addEventListener('pagehide', () => watched.take({ type: 'leave', why: 'hidden' }));
  document.addEventListener('freeze', () => watched.take({ type: 'leave', why: 'hidden' }));
  window.addEventListener('beforeprint', () => watched.take({ type: 'leave', why: 'dialog' }));
}

/** Whether a dialog has been opened by one of the changes. */
function opensDialog({ target, addedNodes }: MutationRecord): boolean {
  return [target, ...addedNodes].some((node) => node instanceof HTMLDialogElement && node.open);
}

function pressable(place: Place): boolean {
  const element = document.getElementById(place);
  return element !== null && !(element as Partial<HTMLButtonElement>).disabled && element.closest('[hidden], [inert]') === null;
}

/** Watches elements that hold something: if they are removed, disabled or hidden, no other event reports it. */
function watchElements(watched: Watched): void {
  const changed = (changes: MutationRecord[]): void => {
    if (!watched.pressed) return;
    if (changes.some(opensDialog)) watched.take({ type: 'leave', why: 'dialog' });
    for (const place of PLACES) if (!pressable(place)) watched.take({ type: 'gone', place });
  };
  new MutationObserver(changed).observe(document.documentElement, {
    subtree: true, childList: true, attributes: true, attributeFilter: ['open', 'disabled', 'hidden', 'inert'],
  });
}

export function watchHolds(watched: Watched): void {
  watchPointers(watched);
  watchKeys(watched);
  watchPage(watched);
  watchElements(watched);
}
