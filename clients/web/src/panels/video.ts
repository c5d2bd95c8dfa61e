// SPDX-License-Identifier: GPL-3.0-or-later
// Records the picture as a video, with the recorder of the browser. The file is saved when the recording is stopped.
import type { Model } from '../model/model';
import type { Viewport } from '../scene/viewport';
import { text } from '../text/text';
import { attempt, button, save } from './dom';

const PICTURES_A_SECOND = 30;
const BITS_A_SECOND = 8_000_000; // tissue is full of fine detail
const STILL_MS = 500; // an unchanged picture is drawn again after this time, so that its duration is recorded
/** Formats; the first that the browser can write is used. WebM comes first, because its pictures may change in size. */
const KINDS = [
  { type: 'video/webm;codecs=vp9', ending: 'webm' },
  { type: 'video/webm;codecs=vp8', ending: 'webm' },
  { type: 'video/mp4', ending: 'mp4' },
];

interface Recording {
  recorder: MediaRecorder;
  still: ReturnType<typeof setInterval>;
}

/** Returns a button that begins and ends a recording; `problem` shows why it cannot. */
export function videoButton(model: Model, viewport: Viewport, problem: HTMLElement): HTMLButtonElement {
  let going: Recording | null = null;
  const press = button(text.video.record, () => void attempt(problem, () => Promise.resolve().then(going ? end : begin)), { id: 'video', ariaPressed: 'false' });

  const show = (): void => {
    press.textContent = going ? text.video.stop : text.video.record;
    press.ariaPressed = String(going !== null);
  };
  const begin = (): void => {
    const kind = 'MediaRecorder' in window ? KINDS.find(({ type }) => MediaRecorder.isTypeSupported(type)) : undefined;
    if (!kind) throw new Error(text.video.unsupported);
    const name = `cautery-${model.session ?? 'view'}-${model.frame?.tick ?? 0}.${kind.ending}`;
    const stream = viewport.canvas.captureStream(PICTURES_A_SECOND);
    const recorder = new MediaRecorder(stream, { mimeType: kind.type, videoBitsPerSecond: BITS_A_SECOND });
    const parts: Blob[] = [];
    recorder.addEventListener('dataavailable', ({ data }) => parts.push(data));
    recorder.addEventListener('error', () => model.notice('error', text.video.stopped));
    recorder.addEventListener('stop', () => {
      stop();
      save(name, new Blob(parts, { type: kind.type }));
      for (const track of stream.getTracks()) track.stop();
    });
    recorder.start();
    going = { recorder, still: setInterval(() => viewport.invalidate(), STILL_MS) };
    viewport.invalidate();
    show();
  };
  const stop = (): void => {
    clearInterval(going?.still);
    going = null;
    show();
  };
  const end = (): void => going?.recorder.stop();
  return press;
}
