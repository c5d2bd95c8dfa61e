// SPDX-License-Identifier: GPL-3.0-or-later
// Your own mesh: the file travels in chunks, the daemon reports what became of it, and a session is
// made of the scene that the daemon puts around it.
import type { Control } from '../model/control';
import { meshWords } from '../model/sentences';
import type { Link } from '../wire/link';
import type { MeshRead, MeshReading } from '../wire/messages.gen';
import { attempt, check, element, field, problemPlace } from './dom';

const TISSUES: readonly (readonly [string, string])[] = [
  ['', 'by the file'],
  ['fat', 'fat (tetrahedra)'],
  ['fascia', 'fascia (triangles)'],
];

const UPLOAD_NAME = 'mesh';

/** The chosen file; the two that TetGen writes as one, the points first. */
function chosen(files: FileList | null): File {
  const [first, second, ...more] = [...(files ?? [])].sort((a, b) => Number(b.name.endsWith('.node')) - Number(a.name.endsWith('.node')));
  if (!first) throw new Error('choose a mesh file first');
  if (first.size === 0) throw new Error('the file is empty');
  if (!second) return first;
  if (more.length > 0 || !first.name.endsWith('.node')) throw new Error('choose one mesh file, or the .node and the .ele file of TetGen');
  return new File([first, '\n', second], first.name);
}

/** The report and the note of a reading, in the words of the form. */
function reportWords({ report, note }: MeshReading): string {
  return meshWords(note === undefined ? report.text : `${report.text}note: ${note}\n`);
}

export function uploadForm(control: Control, link: Link): HTMLElement {
  const { model } = control;
  const problem = problemPlace();
  const file = element('input', { type: 'file', name: 'mesh', multiple: true, required: true });
  const kind = element('select', { name: 'kind' }, ...TISSUES.map(([value, words]) => element('option', { value }, words)));
  const size = element('input', { type: 'number', name: 'unit', placeholder: 'guess', min: '1e-6', max: '1000000', step: 'any' });
  const bar = element('progress', { max: 1, value: 0, hidden: true, aria: { label: 'Upload' } });
  const report = element('pre', { class: 'report', hidden: true, aria: { role: 'status' } });
  const submit = element('button', { type: 'submit' }, 'Upload and create');
  let strict = false;

  const wish = (): MeshRead => ({
    upload: UPLOAD_NAME,
    strict,
    ...(kind.value === 'fat' || kind.value === 'fascia' ? { as: kind.value } : {}),
    ...(size.value === '' ? {} : { unit_m: size.valueAsNumber / 1000 }),
  });
  /** A refusal names no member of a message: the form has words of its own. */
  const read = async (): Promise<MeshReading> => {
    try {
      return await link.call('mesh.read', wish());
    } catch (error) {
      throw new Error(meshWords(error instanceof Error ? error.message : String(error)), { cause: error });
    }
  };
  const work = async (): Promise<void> => {
    const mesh = chosen(file.files);
    report.hidden = true;
    bar.hidden = false;
    bar.value = 0;
    try {
      await link.upload(UPLOAD_NAME, mesh, (sent, total) => (bar.value = sent / total));
      try {
        const reading = await read();
        report.textContent = reportWords(reading);
        report.hidden = false;
        await control.create({ definition: reading.definition });
      } finally {
        // The session has its own copy, and another attempt sends the file again. If this is lost, the
        // next upload takes the place of this one, and the last goes with the connection.
        link.call('upload.discard', { name: UPLOAD_NAME }).catch(() => undefined);
      }
    } finally {
      bar.hidden = true;
    }
  };
  const form = element(
    'form',
    { class: 'form' },
    field('Mesh file', file, '', 'Gmsh, VTK, VTU, OBJ, STL, PLY, Medit, USD text, or both files of TetGen'),
    field('Tissue', kind, '', 'by the file: fat where there are tetrahedra'),
    field('One unit is', size, 'mm', 'length of the file’s unit: 1 for millimetres, 1000 for metres; guessed where its size is clear'),
    check('Strict: refuse a mesh that needs repair', 'strict', (on) => (strict = on)),
    submit,
    bar,
    problem,
    report,
  );
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    void attempt(problem, work, submit);
  });
  const refresh = (): void => {
    submit.disabled = !model.mayOperate || model.hello?.capabilities.includes('upload') !== true;
  };
  model.on('link', refresh);
  refresh();
  return element('details', { class: 'section', id: 'upload' }, element('summary', {}, 'Your own mesh'), form);
}
