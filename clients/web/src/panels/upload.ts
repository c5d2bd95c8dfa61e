// SPDX-License-Identifier: GPL-3.0-or-later
// Uploads a mesh file that the user chose or dropped on the page. The file is sent in chunks. The daemon returns a report
// and a scene around the mesh, from which a session is created.
import type { Control } from '../model/control';
import { meshWords } from '../model/sentences';
import { text } from '../text/text';
import type { Link } from '../wire/link';
import type { MeshRead, MeshReading } from '../wire/messages.gen';
import { attempt, button, check, element, field, problemPlace } from './dom';

const TISSUES = ['fat', 'fascia'] as const;
const SIDES = ['bottom', 'top', 'left', 'right', 'front', 'back', 'left,right', 'front,back', 'none'] as const;

const UPLOAD_NAME = 'mesh';

/** Returns the chosen file. The two files of TetGen are joined, with the points first. */
function chosen(files: FileList | null): File {
  const [first, second, ...more] = [...(files ?? [])].sort((a, b) => Number(b.name.endsWith('.node')) - Number(a.name.endsWith('.node')));
  if (!first) throw new Error(text.upload.noFile);
  if (first.size === 0) throw new Error(text.upload.emptyFile);
  if (!second) return first;
  if (more.length > 0 || !first.name.endsWith('.node')) throw new Error(text.upload.tooManyFiles);
  return new File([first, '\n', second], first.name);
}

/** Returns the report and the note of a reading, in the words of the form. */
function reportWords({ report, note }: MeshReading): string {
  return meshWords(note === undefined ? report.text : `${report.text}${text.upload.note(note)}\n`);
}

/** Returns a choice of these values; the first option is the empty value, with the words for `automatic`. */
function choice<Value extends string>(name: string, values: readonly Value[], words: Readonly<Record<Value | 'automatic', string>>): HTMLSelectElement {
  return element('select', { name }, element('option', { value: '' }, words.automatic), ...values.map((value) => element('option', { value }, words[value])));
}

interface WishFields {
  fields: HTMLElement[];
  read(): MeshRead;
}

/** Returns the fields with the options for reading the file. */
function wishFields(): WishFields {
  const kind = choice('kind', TISSUES, text.upload.tissues);
  const size = element('input', { type: 'number', name: 'unit', placeholder: text.upload.unitGuessed, min: '1e-6', max: '1000000', step: 'any' });
  const edge = element('input', { type: 'number', name: 'edge', placeholder: text.upload.edgeAutomatic, min: '0.001', max: '10000', step: 'any' });
  const labels = element('input', { type: 'text', name: 'labels', placeholder: text.upload.labelsAll, maxLength: 255 });
  const pin = choice('pin', SIDES, text.upload.sides);
  let strict = false;
  return {
    fields: [
      field(text.upload.tissue, kind, '', text.upload.tissueTitle),
      field(text.upload.unit, size, 'mm', text.upload.unitTitle),
      field(text.upload.edge, edge, 'mm', text.upload.edgeTitle),
      field(text.upload.labels, labels, '', text.upload.labelsTitle),
      field(text.upload.pinned, pin, '', text.upload.pinnedTitle),
      check(text.upload.strict, 'strict', (on) => (strict = on)),
    ],
    read: () => ({
      upload: UPLOAD_NAME,
      strict,
      ...(kind.value === 'fat' || kind.value === 'fascia' ? { as: kind.value } : {}),
      ...(size.value === '' ? {} : { unit_m: size.valueAsNumber / 1000 }),
      ...(edge.value === '' ? {} : { edge_m: edge.valueAsNumber / 1000 }),
      ...(labels.value === '' ? {} : { labels: labels.value }),
      ...(pin.value === '' ? {} : { pin: pin.value }),
    }),
  };
}

/** Calls `take` for files that are dropped anywhere on the page. */
function watchDrops(may: () => boolean, take: (files: FileList) => void): void {
  const holdsFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes('Files') === true;
  window.addEventListener('dragover', (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault(); // otherwise the browser opens the file instead of the page
    if (event.dataTransfer) event.dataTransfer.dropEffect = may() ? 'copy' : 'none';
  });
  window.addEventListener('drop', (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    const files = event.dataTransfer?.files;
    if (may() && files && files.length > 0) take(files);
  });
}

/** Returns the section for uploads; `reveal` opens its panel. */
export function uploadForm(control: Control, link: Link, reveal: () => void): HTMLElement {
  const { model } = control;
  const problem = problemPlace();
  const file = element('input', { type: 'file', name: 'mesh', multiple: true, required: true });
  const wish = wishFields();
  const bar = element('progress', { max: 1, value: 0, hidden: true, aria: { label: text.upload.progress } });
  const report = element('pre', { class: 'report', hidden: true, aria: { role: 'status' } });
  const submit = element('button', { type: 'submit' }, text.upload.submit);
  let cancelled = false;
  const discard = (): void => {
    link.call('upload.discard', { name: UPLOAD_NAME }).catch(() => undefined);
  };
  const cancel = button(text.upload.cancel, () => {
    cancelled = true;
    discard(); // this also ends the meshing on the daemon
  }, { hidden: true });

  /** Reads the mesh. Error messages use the words of the form instead of member names. */
  const read = async (): Promise<MeshReading> => {
    try {
      return await link.call('mesh.read', wish.read());
    } catch (error) {
      throw new Error(meshWords(error instanceof Error ? error.message : String(error)), { cause: error });
    }
  };
  const create = async (mesh: File): Promise<void> => {
    await link.upload(UPLOAD_NAME, mesh, (sent, total) => (bar.value = sent / total));
    try {
      bar.removeAttribute('value'); // the duration of filling is unknown
      const reading = await read();
      report.textContent = reportWords(reading);
      report.hidden = false;
      await control.create({ definition: reading.definition });
    } finally {
      // The session has its own copy, and another attempt sends the file again. If this request is lost, the
      // next upload replaces this one, and the connection removes the last upload when it ends.
      discard();
    }
  };
  const work = async (): Promise<void> => {
    const mesh = chosen(file.files);
    report.hidden = true;
    cancelled = cancel.hidden = bar.hidden = false;
    bar.value = 0;
    try {
      await create(mesh);
    } catch (error) {
      throw cancelled ? new Error(text.upload.cancelled, { cause: error }) : error;
    } finally {
      bar.hidden = cancel.hidden = true;
    }
  };
  const form = element(
    'form',
    { class: 'form' },
    field(text.upload.file, file, '', text.upload.fileTitle),
    ...wish.fields,
    element('div', { class: 'buttons' }, submit, cancel),
    bar,
    problem,
    report,
  );
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    void attempt(problem, work, submit);
  });
  const may = (): boolean => model.mayOperate && model.hello?.capabilities.includes('upload') === true;
  const refresh = (): void => {
    submit.disabled = !may();
  };
  model.on('link', refresh);
  refresh();
  const section = element('details', { class: 'section', id: 'upload' }, element('summary', {}, text.upload.title), form);
  watchDrops(may, (files) => {
    file.files = files;
    section.open = true;
    reveal();
    section.scrollIntoView({ block: 'nearest' });
    if (!submit.disabled) form.requestSubmit();
  });
  return section;
}
