// SPDX-License-Identifier: GPL-3.0-or-later
import { errorWords, memberWords, meshWords, sentence, unitText } from '../../../../clients/web/src/model/sentences';
import { nameOf } from '../../../../clients/web/src/model/person';
import { cameraText, readCamera } from '../../../../clients/web/src/panels/address';
import { text } from '../../../../clients/web/src/text/text';
import { PARAMETERS } from '../../../../clients/web/src/wire/messages.gen';
import { RpcError } from '../../../../clients/web/src/wire/connection';

describe('errors for people', () => {
  it('are sentences', () => {
    expect(errorWords(new Error('the store is full'))).toBe('The store is full.');
    expect(errorWords('Choose a file first.')).toBe('Choose a file first.');
    expect(sentence('why?')).toBe('Why?');
  });

  it('name the member as people say it', () => {
    const refused = new RpcError('bad_params', 'Invalid params', 'params.layers[2].young_modulus_pa', 'must be positive');
    expect(errorWords(refused)).toBe('Young modulus: must be positive.');
    expect(memberWords('hot_radius_m')).toBe('Hot radius');
    expect(memberWords('constructor')).toBe('Constructor');
  });

  it('name the member by the catalogue where the catalogue has it', () => {
    const { members } = text.sentences;
    members['hot_radius_m'] = 'Heißer Radius';
    try {
      expect(memberWords('hot_radius_m')).toBe('Heißer Radius');
    } finally {
      delete members['hot_radius_m'];
    }
  });

  it('have no unit left in the name of a number, nor a caret in its unit', () => {
    const all = Object.values(PARAMETERS).flat();
    const left = all.filter(({ name, unit }) => / [a-z]{1,2}\d?$| per s$|_/.test(memberWords(name)) || unitText(unit).includes('^'));
    expect(left.map(({ name }) => memberWords(name))).toEqual([]);
  });

  it('show no rule of a program', () => {
    const refused = new RpcError('bad_params', 'Invalid params', 'params.name', 'must match [a-z][a-z0-9]*([_-][a-z0-9]+)*, at most 48 bytes');
    expect(errorWords(refused)).not.toMatch(/[[\]*()]/);
    expect(errorWords(refused)).toContain('begins with a small letter');
  });

  it('call people by their names, and programs without one by their numbers', () => {
    expect(nameOf({ name: 'Birch 27, viewer 0.1.0', client: 3 })).toBe('Birch 27');
    expect(nameOf({ name: 'cautery 0.1.0', client: 3 })).toBe('cautery 0.1.0');
    expect(nameOf({ name: '', client: 3 })).toBe('client 3');
  });
});

describe('what is said of a mesh', () => {
  it('proposes a unit as the form asks for it', () => {
    expect(meshWords('did you mean millimetres (unit_m 0.001)?')).toBe('did you mean millimetres (one unit is 1 mm)?');
    expect(meshWords('size: 0.1 x 0.1 x 0 m, unit_m 0.01 (centimetres, guessed)')).toBe('size: 0.1 x 0.1 x 0 m, one unit is 10 mm (centimetres, guessed)');
    expect(meshWords('unit_m 1e-06 (micrometres)')).toBe('one unit is 0.001 mm (micrometres)');
    expect(meshWords('unit_m 1e+03.')).toBe('one unit is 1000000 mm.');
  });

  it('names the choice of tissue', () => {
    expect(meshWords('make a sheet of it (as fascia), or a solid (as fat)')).toBe('make a sheet of it (tissue fascia), or a solid (tissue fat)');
  });
});

describe('the camera in an address', () => {
  it('comes back as it was, to a tenth of a degree and of a millimetre', () => {
    const pose = { azimuth: -Math.PI / 2, elevation: 0.85, distance: 0.2134, target: [0.01, -0.002, 0] as [number, number, number] };
    const read = readCamera(cameraText(pose))!;
    expect(read.azimuth).toBeCloseTo(pose.azimuth, 3);
    expect(read.elevation).toBeCloseTo(pose.elevation, 3);
    expect(read.distance).toBeCloseTo(pose.distance, 4);
    expect(read.target.map((value) => Number(value.toFixed(4)))).toEqual([0.01, -0.002, 0]);
  });

  it.each([null, '', '1,2,3', '1,2,x,4,5,6', '1,2,-3,4,5,6', '1,2,3,4,5,6,7'])('is home for %s', (text) => {
    expect(readCamera(text)).toBeNull();
  });
});
