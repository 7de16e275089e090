import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import * as pages from './pages.js';
import { changes, checkMessages, drag, frameOf, kPatience, pixels, waitForExact } from './pages.js';
import { bake, root, run, startServer, vertexBake } from './server.js';

const screenshots = resolve(root, 'tests/e2e/screenshots');
let server;
let browser;

before(async () => {
  mkdirSync(screenshots, { recursive: true });
  server = await startServer({ bakes: [vertexBake, bake] });
  browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox'] });
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

function openPage(session, scene, options) {
  return pages.openPage(browser, `${server.address}?session=${session}&scene=${scene}`, options);
}

function edits(messages) {
  return messages.filter((payload) => typeof payload === 'string').map((text) => JSON.parse(text))
    .filter(({ type }) => type === 'edit');
}

test('the camera moves by the right button, the toggle, keys and the wheel, and goes back', async () => {
  const { page, errors, messages, close } = await openPage('orbit', 'vertices');
  const original = await pixels(page);
  await changes(page, () => drag(page, 120, -40, { button: 'right' }));
  await page.screenshot({ path: resolve(screenshots, 'view.png') });
  await changes(page, () => page.mouse.wheel(0, -300));
  await changes(page, () => page.click('#reset-view'));
  assert.equal(await pixels(page), original, 'the exact picture depends on the state alone');
  await page.check('#drag-camera');
  await changes(page, () => drag(page, -90, 30));
  await page.focus('#canvas');
  for (const key of ['ArrowLeft', 'ArrowUp', '+', 'Shift+ArrowRight', 'Alt+ArrowDown', '-']) {
    await changes(page, () => page.keyboard.press(key));
  }
  const sent = edits(messages);
  assert.ok(sent.length > 8);
  assert.ok(sent.every((edit) => edit.view && !edit.rotation), 'only the camera moved');
  await changes(page, () => page.keyboard.press('Home'));
  assert.equal(await pixels(page), original);
  await page.check('#drag-light');
  await changes(page, () => drag(page, 80, 0));
  assert.ok(edits(messages).at(-1).rotation);
  checkMessages(messages);
  assert.deepEqual(errors, []);
  await close();
});

test('two fingers bring the camera nearer, one turns it', async () => {
  const { page, errors, messages, close } = await openPage('pinch', 'vertices',
    { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 });
  await page.check('#drag-camera', { force: true });
  const box = await page.locator('#canvas').boundingBox();
  const client = await page.context().newCDPSession(page);
  const middle = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  const touch = (type, ...offsets) => client.send('Input.dispatchTouchEvent', { type,
    touchPoints: offsets.map((dx, id) => ({ x: middle.x + dx, y: middle.y, id })) });
  await changes(page, async () => {
    await touch('touchStart', -30);
    await touch('touchStart', -30, 30);
    for (let i = 1; i <= 8; ++i) {
      await touch('touchMove', -30 - 5 * i, 30 + 5 * i);
      await page.waitForTimeout(16);
    }
    await touch('touchEnd');
  });
  const { view } = edits(messages).at(-1);
  const { camera } = JSON.parse(messages.find((text) => typeof text === 'string'));
  const distance = ({ position, target }) => Math.hypot(...position.map((x, i) => x - target[i]));
  assert.ok(distance(view.camera) < 0.7 * distance(camera));
  await page.screenshot({ path: resolve(screenshots, 'view_phone.png') });
  assert.deepEqual(errors, []);
  await close();
});

test('materials are edited and taken back, and frames say what does not follow', async () => {
  const { page, errors, messages, close } = await openPage('materials', 'vertices');
  const other = await openPage('materials', 'vertices');
  const original = await pixels(page);
  await page.selectOption('#material-choice', 'clay');
  await changes(page, () => page.fill('#material-exponent', '90'));
  await changes(page, () => page.fill('#material-highlight', '0.8'));
  assert.equal(await page.textContent('#material-highlight-value'), '80 %');
  await changes(page, () => page.fill('#material-albedo', '#2060d0'));
  assert.match(await page.textContent('#quality'), /not shown: .*keeps the albedo of the bake/);
  await page.screenshot({ path: resolve(screenshots, 'materials.png') });
  await other.page.selectOption('#material-choice', 'clay');
  await other.page.waitForFunction(
    () => document.getElementById('material-albedo').value === '#2060d0', undefined,
    { timeout: kPatience });
  await changes(page, () => page.click('#reset-material'));
  assert.equal(await pixels(page), original);
  assert.doesNotMatch(await page.textContent('#quality'), /not shown/);
  checkMessages(messages);
  assert.deepEqual(errors, []);
  await close();
  await other.close();
});

test('a highlight takes a shape, by keys too, and gives it back to its sharpness', async () => {
  const { page, errors, messages, close } = await openPage('lobes', 'vertices');
  const other = await openPage('lobes', 'vertices');
  for (const one of [page, other.page]) await one.selectOption('#material-choice', 'clay');
  await changes(page, () => page.fill('#material-highlight', '0.9'));
  const phong = await pixels(page);
  await page.focus('#material-lobe');
  await changes(page, () => page.keyboard.press('ArrowDown'));
  await changes(page, () => page.keyboard.press('ArrowDown'));
  const ring = await pixels(page);
  assert.notEqual(ring, phong);
  await page.screenshot({ path: resolve(screenshots, 'lobes.png') });
  const { lobe } = edits(messages).at(-1).material.parameter.clay;
  assert.equal(lobe.indexOf(Math.max(...lobe)) * 90 / (lobe.length - 1), 30);
  const showsOther = (name) => other.page.waitForFunction(
    (value) => document.getElementById('material-lobe').value === value, name, { timeout: kPatience });
  await showsOther('ring');
  await changes(page, () => page.selectOption('#material-lobe', 'phong'));
  assert.equal(await pixels(page), phong);
  await showsOther('phong');
  await changes(page, () => page.selectOption('#material-lobe', 'ring'));
  assert.equal(await pixels(page), ring);
  await changes(page, () => page.fill('#material-exponent', '30'));
  assert.equal(await page.inputValue('#material-lobe'), 'phong');
  await showsOther('phong');
  assert.ok(!('lobe' in edits(messages).at(-1).material.parameter.clay));
  checkMessages(messages);
  assert.deepEqual(errors, []);
  await close();
  await other.close();
});

test('lobes that are none get an error, and the state stays', async () => {
  const { page, errors, close } = await openPage('bad-lobes', 'vertices');
  const replies = await page.evaluate((address) => new Promise((done) => {
    const socket = new WebSocket(address);
    const lobes = [[], [1], [0, 0], [-1, 1], [1, 1000001], 'ring', [[1, 2]], Array(65).fill(1)];
    const texts = [];
    socket.onopen = () => lobes.forEach((lobe, i) => socket.send(JSON.stringify({ type: 'edit',
      id: `bad ${i}`, exposure: 3, material: { parameter: { clay: { lobe } } } })));
    socket.onmessage = ({ data }) => {
      if (typeof data !== 'string') return;
      texts.push(JSON.parse(data));
      if (texts.length === lobes.length) socket.send(JSON.stringify({ type: 'edit', id: 'good', exposure: 1 }));
      if (texts.at(-1).id === 'good') done(texts);
    };
  }), `ws://${server.host}/sessions/bad-lobes/stream?scene=vertices`);
  const refused = replies.filter(({ type }) => type === 'error');
  assert.equal(refused.length, 8);
  for (const { reason } of refused) assert.match(reason, /\/material\/parameter\/clay\/lobe/);
  const { state } = replies.at(-1);
  assert.equal(state.exposure, 1);
  assert.deepEqual(state.material.parameter, {});
  assert.deepEqual(errors, []);
  await close();
});

test('edits in one frame keep the order of a shape and a sharpness', async () => {
  const { merged } = await import('../../web/js/edits.js');
  const of = (clay) => ({ material: { parameter: { clay } } });
  const both = (...changes) => changes.map(of).reduce(merged).material.parameter.clay;
  assert.deepEqual(both({ lobe: [0, 1] }, { exponent: 7 }), { exponent: 7 });
  assert.deepEqual(both({ exponent: 7 }, { lobe: [0, 1] }), { exponent: 7, lobe: [0, 1] });
  assert.deepEqual(both({ exponent: 7 }, { lobe: [0, 1] }, { lobe: null }), { exponent: 7, lobe: null });
  assert.deepEqual(both({ lobe: [0, 1] }, { exponent: 7 }, { albedo: [1, 1, 1] }),
    { exponent: 7, albedo: [1, 1, 1] });
});

test('a bake of one image offers no camera, keeps a view all the same, and says so', async () => {
  const { page, errors, close } = await openPage('image', 'balls');
  for (const id of ['drag', 'reset-view', 'materials']) {
    assert.equal(await page.isVisible(`#${id}`), false, id);
  }
  const frame = await frameOf(page);
  await page.evaluate((address) => new Promise((done) => {
    const socket = new WebSocket(address);
    socket.onopen = () => socket.send(JSON.stringify({ type: 'edit', id: '1', view: { camera:
      { position: [1, 2, 3], target: [0, 0, 0], up: [0, 1, 0], fov: 40 } } }));
    socket.onmessage = ({ data }) => typeof data === 'string' && JSON.parse(data).type === 'ack' && done();
  }), `ws://${server.host}/sessions/image/stream?scene=balls`);
  await waitForExact(page, frame);
  assert.match(await page.textContent('#quality'), /not shown: the moved camera/);
  assert.deepEqual(errors, []);
  await close();
});

test('rimlight load finds the frames of vertices equal to its own render', async () => {
  const { code, stdout, stderr } = await run(['load', '--url', `ws://${server.host}`, '--clients',
    '2', '--seconds', '2', '--bake', vertexBake, '--json']);
  assert.equal(code, 0, stdout + stderr);
  assert.ok(JSON.parse(stdout).checks.every((check) => check.pass === true), stdout);
});

test('a light of vertices has a fitted window unless another is asked for', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'rimlight-window-'));
  const picture = async (...options) => {
    const file = join(folder, 'picture.png');
    const { code, stderr } = await run(['render', vertexBake, '--light', 'sunny', '-o', file, ...options]);
    assert.equal(code, 0, stderr);
    return readFileSync(file).toString('base64');
  };
  const plain = await picture();
  assert.equal(await picture('--window', 'fitted'), plain);
  assert.notEqual(await picture('--window', 'none'), plain);
  const { code, stderr } = await run(['render', bake, '--window', 'hann', '-o', join(folder, 'x.png')]);
  assert.notEqual(code, 0);
  assert.match(stderr, /--window: .*expected a bake of kind vertex_sh/);
  const config = join(folder, 'config.json');
  writeFileSync(config, JSON.stringify({ bakes: [vertexBake], window: 'soft' }));
  const served = await run(['serve', '--config', config]);
  assert.notEqual(served.code, 0);
  assert.match(served.stderr, /\/window: found "soft"/);
  rmSync(folder, { recursive: true });
});
