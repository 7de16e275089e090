import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { test } from 'node:test';
import { compile, faults, parseWithComments, readSchema, validators } from './schemas.js';
import { root } from './server.js';

test('every schema has examples, and they fit', () => {
  assert.ok(validators.size >= 12);
  for (const [kind, validate] of validators) {
    assert.ok(validate.schema.examples.length > 0, kind);
    for (const example of validate.schema.examples) assert.equal(faults(kind, example), '');
  }
});

test('no schema takes a misspelt field, or a message of another type', () => {
  for (const [kind, validate] of validators) {
    const [example] = validate.schema.examples;
    assert.notEqual(faults(kind, { ...example, mispelt: 1 }), '', kind);
    if (example.type) assert.notEqual(faults(kind, { ...example, type: 'other' }), '', kind);
  }
});

test('every page of docs/protocol has examples that fit its schemas', () => {
  const pages = readdirSync(resolve(root, 'docs/protocol')).filter((name) => name.endsWith('.md'));
  let checked = 0;
  for (const page of pages) {
    const text = readFileSync(resolve(root, 'docs/protocol', page), 'utf8');
    const kinds = [...text.matchAll(/\(schema\/(\w+)\.schema\.json\)/g)].map((match) => match[1]);
    const examples = [...text.matchAll(/```json\n([\s\S]*?)```/g)].map((match) => match[1]);
    for (const example of examples) {
      const value = parseWithComments(example);
      assert.ok(kinds.some((kind) => faults(kind, value) === ''), `${page}: ${example}`);
      checked += 1;
    }
    if (page !== 'README.md') assert.ok(examples.length > 0, page);
  }
  assert.ok(checked >= 12);
});

test('the asyncapi document names every message, and only schemas that exist', () => {
  const text = readFileSync(resolve(root, 'docs/protocol/asyncapi.yaml'), 'utf8');
  const named = [...text.matchAll(/schema\/(\w+)\.schema\.json/g)].map((match) => match[1]);
  for (const kind of named) assert.ok(validators.has(kind), kind);
  for (const [kind, { schema }] of validators) {
    if (schema.properties.type) assert.ok(named.includes(kind), kind);
  }
});

test('the example configurations and load scripts fit', () => {
  const read = (name) => parseWithComments(readFileSync(resolve(root, name), 'utf8'));
  assert.equal(faults('server_config', read('configs/server.json')), '');
  assert.equal(faults('load_script', read('configs/load/swing.json')), '');
});

/** Holds a schema of docs/formats to a folder of good and bad examples. */
function checkExamples(schema, folder, schemas = 'docs/formats') {
  const validate = compile(readSchema(resolve(root, schemas, schema)));
  for (const [kind, expected] of [['good', true], ['bad', false], ['bad_beyond_schema', true]]) {
    const files = readdirSync(resolve(root, folder, kind)).filter((name) => name.endsWith('.json'));
    assert.ok(files.length > 0, kind);
    for (const name of files) {
      const value = parseWithComments(readFileSync(resolve(root, folder, kind, name), 'utf8'));
      assert.equal(validate(value), expected, `${kind}/${name}: ${JSON.stringify(validate.errors)}`);
    }
  }
  return validate;
}

test('the schema of configurations takes the good examples and refuses the bad', () => {
  checkExamples('server_config.schema.json', 'tests/cli/configurations', 'docs/protocol/schema');
});

test('the scene schema takes the good examples and refuses the bad', () => {
  checkExamples('scene.schema.json', 'tests/core/scene/examples');
});

test('the schema of light directions takes the good examples and that of its page, and refuses the bad', () => {
  const validate = checkExamples('directions.schema.json', 'tests/core/import/examples');
  const page = readFileSync(resolve(root, 'docs/formats/import.md'), 'utf8');
  const [, example] = page.match(/```json\n([\s\S]*?)```/);
  assert.ok(validate(parseWithComments(example)), JSON.stringify(validate.errors));
});

test('the light sequence schema takes the good examples and the built-in sequences, and refuses the bad', () => {
  const validate = checkExamples('light_sequence.schema.json', 'tests/core/light/sequences');
  const files = readdirSync(resolve(root, 'configs/sequences'));
  assert.ok(files.length >= 5);
  for (const name of files) {
    const value = parseWithComments(readFileSync(resolve(root, 'configs/sequences', name), 'utf8'));
    assert.ok(validate(value), `${name}: ${JSON.stringify(validate.errors)}`);
  }
  const page = readFileSync(resolve(root, 'docs/formats/light_sequence.md'), 'utf8');
  const [, example] = page.match(/```json\n([\s\S]*?)```/);
  assert.ok(validate(parseWithComments(example)), JSON.stringify(validate.errors));
});
