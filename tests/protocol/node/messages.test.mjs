// SPDX-License-Identifier: GPL-3.0-or-later
// Every message that the C side writes is valid by protocol/asyncapi.json, and the schemas do refuse.
import Ajv from 'ajv';
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';

const document = JSON.parse(readFileSync(process.env.CAUTERY_ASYNCAPI, 'utf8'));
const lines = readFileSync(join(process.env.CAUTERY_GOLDEN, 'messages.jsonl'), 'utf8').trim().split('\n');
const messages = lines.map((line) => JSON.parse(line));
const ajv = new Ajv({ strict: false, allErrors: true });
ajv.addSchema(document, 'asyncapi');
const validators = new Map(
  Object.keys(document.components.messages).map((name) => [
    name,
    ajv.compile({ $ref: `asyncapi#/components/messages/${name}/payload` }),
  ]),
);

test('every message of the document was written, and is valid', () => {
  assert.deepEqual(new Set(messages.map(({ message }) => message)), new Set(validators.keys()));
  for (const { message, payload } of messages) {
    const validate = validators.get(message);
    assert.ok(validate(payload), `${message}: ${ajv.errorsText(validate.errors)}\n${JSON.stringify(payload)}`);
  }
});

test('unknown members, missing members and wrong types are refused', () => {
  let tried = 0;
  for (const { message, payload } of messages) {
    const validate = validators.get(message);
    if (message.endsWith('.result') || message === 'error') continue;
    assert.ok(!validate({ ...payload, extra: 1 }), `${message} with an extra member`);
    if (!validate({ ...payload, params: {} }))
      for (const key of Object.keys(payload.params))
        assert.ok(!validate({ ...payload, params: { ...payload.params, [key]: null } }), `${message} with ${key} null`);
    tried++;
  }
  assert.ok(tried > 40);
});

test('every reference leads somewhere', () => {
  const find = (path) => path.slice(2).split('/').reduce((at, key) => at?.[key], document);
  const walk = (value) => {
    if (value === null || typeof value !== 'object') return;
    if (typeof value.$ref === 'string') assert.ok(find(value.$ref), value.$ref);
    Object.values(value).forEach(walk);
  };
  walk(document);
});
