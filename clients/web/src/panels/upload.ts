// SPDX-License-Identifier: GPL-3.0-or-later
// Uploads a mesh file that the user chose or dropped on the page. The file is sent in chunks. The daemon returns a report
// and a scene around the mesh, from which a session is created.
import type { Control } from '../model/control';
import { meshWords } from '../model/sentences';
import type { Link } from '../wire/link';
import type { MeshRead, MeshReading } from '../wire/messages.gen';
import { attempt, button, check, element, field, problemPlace } from './dom';

const TISSUES: readonly (readonly [string, string])[] = [
  ['', 'automatic'],
  ['fat', 'fat (tetrahedra)'],
  ['fascia', 'fascia (triangles)'],
];
const SIDES: readonly (readonly [string, string])[] = [
  ['', 'automatic'],
  ...['bottom', 'top', 'left', 'right', 'front', 'back', 'left,right', 'front,back', 'none'].map((side) => [side, side.replace(',', ' and ')] as const),
];

const UPLOAD_NAME = 'mesh';

/** Returns the chosen file. The two files of TetGen are joined, with the points first. */
function chosen(files: FileList | null): File {
  const [first, second, ...more] = [...(files ?? [])].sort((a, b) => Number(b.name.endsWith('.node')) - Number(a.name.endsWith('.node')));
  if (!first) throw new Error('choose a mesh file first');
  if (first.size === 0) throw new Error('the file is empty');
  if (!second) return first;
  if (more.length > 0 || !first.name.endsWith('.node')) throw new Error('choose one mesh file, or the .node and the .ele file of TetGen');
  return new File([first, '\n', second], first.name);
}

/** Returns the report and the note of a reading, in the words of the form. */
function reportWords({ report, note }: MeshReading): string {
  return meshWords(note === undefined ? report.text : `${report.text}note: ${note}\n`);
}

function choice(name: string, of: readonly (readonly [string, string])[]): HTMLSelectElement {
  return element('select', { name }, ...of.map(([value, words]) => element('option', { value }, words)));
}

interface WishFields {
  fields: HTMLElement[];
  read(): MeshRead;
}

/** Returns the fields with the options for reading the file. */
function wishFields(): WishFields {
  const kind = choice('kind', TISSUES);
  const size = element('input', { type: 'number', name: 'unit', placeholder: 'guessed', min: '1e-6', max: '1000000', step: 'any' });
  const edge = element('input', { type: 'number', name: 'edge', placeholder: 'automatic', min: '0.001', max: '10000', step: 'any' });
  const labels = element('input', { type: 'text', name: 'labels', placeholder: 'all', maxLength: 255 });
  const pin = choice('pin', SIDES);
  let strict = false;
  return {
    fields: [
      field('Tissue', kind, '', 'automatic: fat if the file has tetrahedra or a closed surface, else fascia'),
      field('One unit is', size, 'mm', 'length of one unit of the file: 1 for millimetres, 1000 for metres. Empty: guessed from the size of the mesh.'),
      field('Edge length', edge, 'mm', 'edge length of the tetrahedra that fill a surface or a segmentation'),
      field('Labels', labels, '', 'labels of the segmentation to use, for example 1,3'),
      field('Pinned', pin, '', 'automatic: the bottom, or the rim of a sheet. Add pins with Pin in the picture.'),
      check('Strict: refuse a mesh with errors instead of repairing it', 'strict', (on) => (strict = on)),
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
  const bar = element('progress', { max: 1, value: 0, hidden: true, aria: { label: 'Upload' } });
  const report = element('pre', { class: 'report', hidden: true, aria: { role: 'status' } });
  const submit = element('button', { type: 'submit' }, 'Upload and create');
  let cancelled = false;
  const discard = (): void => {
    link.call('upload.discard', { name: UPLOAD_NAME }).catch(() => undefined);
  };
  const cancel = button('Cancel', () => {
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
      throw cancelled ? new Error('cancelled', { cause: error }) : error;
    } finally {
      bar.hidden = cancel.hidden = true;
    }
  };
  const form = element(
    'form',
    { class: 'form' },
    field('Mesh file', file, '', 'formats: Gmsh, VTK, VTU, OBJ, STL, PLY, Medit, USD text, NRRD, NIfTI, or both files of TetGen'),
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
  const section = element('details', { class: 'section', id: 'upload' }, element('summary', {}, 'Your own mesh'), form);
  watchDrops(may, (files) => {
    file.files = files;
    section.open = true;
    reveal();
    section.scrollIntoView({ block: 'nearest' });
    if (!submit.disabled) form.requestSubmit();
  });
  return section;
}
