// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh of one's own: the file travels in chunks, then a session is made of it.
import type { Control } from '../model/control';
import { sceneOfMesh, type MeshKind } from '../model/mesh_scene';
import type { Link } from '../wire/link';
import { attempt, element, field, problemPlace } from './dom';

const MESH_KINDS: readonly (readonly [MeshKind, string])[] = [
  ['fat', 'fat (tetrahedra)'],
  ['fascia', 'fascia (triangles)'],
];

const UPLOAD_NAME = 'mesh';

export function uploadForm(control: Control, link: Link): HTMLElement {
  const { model } = control;
  const problem = problemPlace();
  const file = element('input', { type: 'file', name: 'mesh', accept: '.msh,.obj,.vtk,.vtu,.vtp,.stl,.ply,.mesh,.meshb,.usda', required: true });
  const kind = element('select', { name: 'kind' }, ...MESH_KINDS.map(([value, words]) => element('option', { value }, words)));
  const size = element('input', { type: 'number', name: 'unit', value: '10', min: '1e-6', max: '1000000', step: 'any', required: true });
  const bar = element('progress', { max: 1, value: 0, hidden: true, aria: { label: 'Upload' } });
  const submit = element('button', { type: 'submit' }, 'Upload and create');
  file.addEventListener('change', () => {
    const obj = file.files?.[0]?.name.endsWith('.obj') === true;
    kind.value = obj ? 'fascia' : 'fat';
  });
  const work = async (): Promise<void> => {
    const mesh = file.files?.[0];
    if (!mesh) throw new Error('choose a mesh file first');
    bar.hidden = false;
    bar.value = 0;
    try {
      const uploaded = await link.upload(UPLOAD_NAME, mesh, (sent, total) => (bar.value = sent / total));
      try {
        await control.create({ definition: sceneOfMesh(uploaded.file, kind.value as MeshKind, size.valueAsNumber / 1000) });
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
    field('Mesh file', file, '', 'Gmsh, VTK, VTU, OBJ, STL, PLY, Medit or USD text'),
    field('Tissue', kind),
    field('One unit is', size, 'mm', 'length of the file’s unit: 1 for millimetres, 1000 for metres'),
    submit,
    bar,
    problem,
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
