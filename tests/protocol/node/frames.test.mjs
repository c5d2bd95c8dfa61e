// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes what the C encoder wrote into $CAUTERY_GOLDEN and compares bit by bit.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';
import { Corrupt, Refused, SCALARS, StreamDecoder, decodeTopology } from './decode.mjs';

const folder = process.env.CAUTERY_GOLDEN;
const read = (name) => new Uint8Array(readFileSync(join(folder, name)));
const manifest = JSON.parse(readFileSync(join(folder, 'streams.json'), 'utf8'));
const FLOATS = ['position', 'rotation', 'asked', 'askedRotation', 'jaw', 'askedJaw', 'jawForce', 'force', 'torque', 'temperature', 'energy', 'power', 'load', 'rawForce', 'rawTorque', 'forceFilter'];

function compareTools(tools, expected) {
  assert.equal(tools.length, expected.length);
  tools.forEach((tool, i) => {
    assert.equal('rawForce' in tool, 'rawForce' in expected[i]);
    for (const key of Object.keys(expected[i])) {
      const want = expected[i][key];
      if (FLOATS.includes(key)) assert.deepEqual(tool[key], want.map(Math.fround), key);
      else assert.equal(key === 'sequence' ? Number(tool[key]) : tool[key], want, key);
    }
  });
}

function compareVessels(vessels, expected) {
  assert.equal(vessels.length, expected.length);
  vessels.forEach((vessel, i) => {
    const { name, flags, scalars, points } = expected[i];
    assert.deepEqual(vessel, { name, flags, scalars: scalars.map(Math.fround), points: points.map(Math.fround) });
  });
}

function compareContacts(contacts, expected) {
  assert.equal(contacts.length, expected.length);
  contacts.forEach((contact, i) => {
    const rounded = Object.entries(expected[i]).map(([key, value]) => [key, Array.isArray(value) ? value.map(Math.fround) : value]);
    assert.deepEqual(contact, Object.fromEntries(rounded));
  });
}

function compareState(decoder, state) {
  assert.equal(decoder.epoch.toString(16).padStart(16, '0'), state.epoch);
  assert.equal(Number(decoder.sequence), state.sequence);
  assert.equal(Number(decoder.tick), state.tick);
  assert.equal(decoder.time, state.time);
  for (const key of ['quantised', 'mask', ...SCALARS.map(({ name }) => name)])
    assert.deepEqual(decoder[key], Int32Array.from(state[key], (value) => value | 0), key);
  assert.equal(decoder.statistics.iterations, state.iterations);
  assert.equal(decoder.statistics.contacts, state.contacts);
  compareTools(decoder.tools, state.tools);
  compareVessels(decoder.vessels ?? [], state.vessels);
  compareContacts(decoder.toolContacts ?? [], state.toolContacts);
}

test('every stream decodes to what the C decoder holds', () => {
  const widths = new Set();
  const codings = new Set();
  for (const stream of manifest.streams) {
    const decoder = new StreamDecoder(manifest);
    for (const frame of stream.frames) {
      const decode = () => decoder.decode(read(frame.file));
      if (frame.expect === 'refused') {
        const before = decoder.quantised.slice();
        assert.throws(decode, Refused, frame.file);
        assert.ok(decoder.synced);
        assert.deepEqual(decoder.quantised, before);
      } else if (frame.expect === 'corrupt') {
        assert.throws(decode, Corrupt, frame.file);
        assert.ok(!decoder.synced);
      } else {
        decode();
        compareState(decoder, frame.state);
      }
    }
    decoder.widths.forEach((width) => widths.add(width));
    decoder.codings.forEach((coding) => codings.add(coding));
  }
  assert.deepEqual([...widths].sort(), [1, 2, 4], 'numbers of every width were seen');
  assert.deepEqual([...codings].sort(), [0, 1], 'both codings were seen');
});

test('a key frame in the middle makes the same state as the chain', () => {
  const [stream] = manifest.streams;
  const last = stream.frames.at(-1);
  const late = new StreamDecoder(manifest);
  late.decode(read(last.file));
  compareState(late, last.state);
});

test('the topology frame decodes', () => {
  const expected = JSON.parse(readFileSync(join(folder, 'topology.json'), 'utf8'));
  const topology = decodeTopology(read('topology.bin'), manifest.vertexCount, manifest.faceCount);
  assert.deepEqual([...topology.faces], expected.faces);
  assert.deepEqual([...topology.layers], expected.layers);
  assert.deepEqual([...topology.rest], expected.rest);
  assert.deepEqual([...topology.texture], expected.texture.map(Math.fround));
});
