// SPDX-License-Identifier: GPL-3.0-or-later
// Records the shown scene ten times a second as an MCAP file, for Foxglove and other players.
import type { Model } from '../model/model';
import type { LayerFaces, SeenMoment } from '../model/scene_update';
import type { TissueView } from '../scene/tissue_view';
import type { Viewport } from '../scene/viewport';
import { text } from '../text/text';
import type { FromMcap, ToMcap } from '../wire/mcap_worker';
import type { Frame } from '../wire/worker_messages';
import { attempt, button, save } from './dom';

const STEP_MS = 100;
const NS_IN_MS = 1_000_000n;

interface Recording {
  worker: Worker;
  timer: ReturnType<typeof setInterval>;
  session: string | null;
  startedMs: number;
  /** number of the last recorded step since the beginning */
  step: number;
  seen: Frame | null;
}

/** Returns the present faces by layer, also of hidden layers. */
function facesOf(tissue: TissueView): LayerFaces[] {
  const layers = new Map<string, Uint32Array[]>();
  tissue.joined.batches.forEach(({ layer }, b) => {
    const lists = layers.get(layer) ?? [];
    const index = tissue.indices[b];
    if (index) lists.push(index);
    layers.set(layer, lists);
  });
  return [...layers].map(([layer, lists]) => ({ layer, lists }));
}

/** Returns a button that begins and ends a recording; `problem` shows why it cannot. */
export function sceneRecordingButton(model: Model, viewport: Viewport, problem: HTMLElement): HTMLButtonElement {
  let going: Recording | null = null;
  const press = button(text.sceneRecording.record, () => void attempt(problem, () => Promise.resolve().then(going ? end : begin)), { id: 'mcap', ariaPressed: 'false' });
  const show = (): void => {
    press.textContent = going ? text.sceneRecording.stop : text.sceneRecording.record;
    press.ariaPressed = String(going !== null);
  };
  const send = (recording: Recording, message: ToMcap): void => recording.worker.postMessage(message);

  // Times are multiples of STEP_MS. A busy page leaves steps out.
  const take = (recording: Recording): void => {
    const { frame } = model;
    const { tissue } = viewport;
    const step = Math.floor((performance.now() - recording.startedMs) / STEP_MS);
    if (step <= recording.step || frame === recording.seen || !frame || !tissue) return;
    recording.step = step;
    recording.seen = frame;
    const moment: SeenMoment = {
      timeNs: BigInt(Math.round(performance.timeOrigin + recording.startedMs) + step * STEP_MS) * NS_IN_MS,
      tick: frame.past?.tick ?? frame.tick,
      timeS: frame.past?.timeS ?? frame.timeS,
      position: tissue.position.array as Float32Array,
      layers: facesOf(tissue),
      tools: frame.past?.tools ?? frame.tools,
    };
    send(recording, { type: 'moment', moment }); // a copy
  };
  const finish = (recording: Recording, words?: string): void => {
    clearInterval(recording.timer);
    recording.worker.terminate();
    if (going === recording) going = null;
    if (words !== undefined) model.notice('error', words);
    show();
  };
  const begin = (): void => {
    const worker = new Worker(new URL('../wire/mcap_worker.ts', import.meta.url), { type: 'module' });
    const recording: Recording = {
      worker,
      timer: setInterval(() => take(recording), STEP_MS / 4),
      session: model.session,
      startedMs: performance.now(),
      step: -1,
      seen: null,
    };
    worker.addEventListener('error', () => finish(recording, text.sceneRecording.workerFailed));
    worker.addEventListener('message', ({ data }: MessageEvent<FromMcap>) => {
      if (data.type === 'failure') finish(recording, text.sceneRecording.failed(data.message));
      if (data.type === 'full') {
        model.notice('warning', text.sceneRecording.full);
        end();
      }
      if (data.type !== 'file') return;
      save(`cautery-${recording.session ?? 'view'}-${model.frame?.tick ?? 0}.mcap`, data.file);
      finish(recording);
    });
    going = recording;
    show();
  };
  const end = (): void => {
    if (!going) return;
    clearInterval(going.timer);
    send(going, { type: 'end' });
    going = null;
    show();
  };
  return press;
}
