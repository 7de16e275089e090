// The JSON Schemas of docs/, compiled.
import Ajv2020 from 'ajv/dist/2020.js';
import { readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { root } from './server.js';

export const folder = resolve(root, 'docs/protocol/schema');

export function readSchema(file) {
  return JSON.parse(readFileSync(file, 'utf8'));
}

export function compile(schema) {
  return new Ajv2020({ strict: true, allErrors: true, strictRequired: false }).compile(schema);
}

/** Message type → validate function, for every schema of the protocol. */
export const validators = new Map(
  readdirSync(folder).filter((name) => name.endsWith('.schema.json')).map((name) => {
    const schema = readSchema(join(folder, name));
    return [name.replace('.schema.json', ''), Object.assign(compile(schema), { schema })];
  }));

/** What is wrong with a value, in words; empty when nothing is. */
export function faults(kind, value) {
  const validate = validators.get(kind);
  if (!validate) return `no schema for ${kind}`;
  return validate(value) ? '' : `${kind}: ${JSON.stringify(validate.errors)} in ${JSON.stringify(value)}`;
}

/** JSON with // comments, as the program reads it. */
export function parseWithComments(text) {
  return JSON.parse(text.replace(/("(?:[^"\\]|\\.)*")|\/\/[^\n]*/g, (_, string) => string ?? ''));
}
