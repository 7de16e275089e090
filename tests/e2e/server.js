// Starts the built server on a free port, and stops it again.
import { spawn } from 'node:child_process';
import { dirname, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

export const root = resolve(dirname(fileURLToPath(import.meta.url)), '../..');

function required(name) {
  const value = process.env[name];
  if (!value) throw new Error(`${name} is not set: run this through ctest`);
  return value;
}

export const program = required('RIMLIGHT');
export const bake = required('RIMLIGHT_BAKE');
export const vertexBake = process.env.RIMLIGHT_VERTEX_BAKE;
export const curveBake = process.env.RIMLIGHT_CURVE_BAKE;

/** Resolves to {address, host, port, stop, kill} when the server is ready. */
export function startServer({ port = 0, bakes = [bake], more = [] } = {}) {
  return started(program, ['serve', ...bakes, '--port', String(port), '--json',
    '--web', resolve(root, 'web'), ...more]);
}

/** The same page with a scene "curves" whose BRDFs are edited. */
export function startCurveServer() {
  return started(required('RIMLIGHT_CURVE_SERVER'), [resolve(root, 'web')]);
}

function started(command, args) {
  const child = spawn(command, args, { stdio: ['ignore', 'pipe', 'pipe'] });
  let log = '';
  child.stderr.on('data', (data) => { log += data; });
  const ended = new Promise((done) => child.on('exit', (code, signal) => done({ code, signal })));
  return new Promise((ready, fail) => {
    ended.then(({ code }) => fail(new Error(`the server ended with ${code}:\n${log}`)));
    child.stdout.once('data', (data) => {
      const { address } = JSON.parse(String(data));
      const url = new URL(address);
      ready({
        address,
        host: url.host,
        port: Number(url.port),
        stop: () => { child.kill('SIGTERM'); return ended; },
        kill: () => { child.kill('SIGKILL'); return ended; },
      });
    });
  });
}

/** Runs the program to its end: {code, stdout, stderr}. */
export function run(args) {
  return new Promise((done) => {
    const child = spawn(program, args);
    let stdout = '';
    let stderr = '';
    child.stdout.on('data', (data) => { stdout += data; });
    child.stderr.on('data', (data) => { stderr += data; });
    child.on('exit', (code) => done({ code, stdout, stderr }));
  });
}
