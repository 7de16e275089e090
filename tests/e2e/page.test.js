import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import * as pages from './pages.js';
import { checkMessages, drag, frameOf, kPatience, pixels, waitForExact } from './pages.js';
import { faults } from './schemas.js';
import { root, run, bake, startServer } from './server.js';

const screenshots = resolve(root, 'tests/e2e/screenshots');
let server;
let browser;

before(async () => {
  mkdirSync(screenshots, { recursive: true });
  server = await startServer();
  browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox'] });
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

function openPage(session, options) {
  return pages.openPage(browser, `${server.address}?session=${session}`, options);
}

test('a drag turns the light, and the picture is exact when it stops', async () => {
  const { page, errors, messages, close } = await openPage('drag');
  const before = await pixels(page);
  const first = await frameOf(page);
  await drag(page, 220, -60);
  await page.screenshot({ path: resolve(screenshots, 'turning.png') });
  assert.ok(await frameOf(page) > first + 2, 'frames came during the drag');
  await waitForExact(page, first);
  assert.notEqual(await pixels(page), before);
  await page.waitForTimeout(300);
  const last = await frameOf(page);
  await page.waitForTimeout(300);
  assert.equal(await frameOf(page), last, 'nothing comes while nothing is edited');
  assert.equal(await page.textContent('#stat-exact'), 'exact');
  assert.match(await page.textContent('#stat-latency'), /\d+ ms/);
  await page.screenshot({ path: resolve(screenshots, 'exact.png') });
  const kinds = checkMessages(messages);
  for (const kind of ['welcome', 'edit', 'ack', 'frame', 'frame_ack']) assert.ok(kinds.has(kind), kind);
  assert.deepEqual(errors, []);
  await close();
});

test('keys, environments, exposure and the buttons change the picture and go back', async () => {
  const { page, errors, messages, close } = await openPage('controls');
  const original = await pixels(page);
  const changes = async (act) => {
    const [frame, old] = [await frameOf(page), await pixels(page)];
    await act();
    await waitForExact(page, frame);
    assert.notEqual(await pixels(page), old);
  };
  await page.focus('#canvas');
  await changes(() => page.keyboard.press('ArrowRight'));
  await changes(() => page.keyboard.press('ArrowUp'));
  await changes(() => page.click('#reset-rotation'));
  assert.equal(await pixels(page), original, 'the exact picture depends on the state alone');
  const names = await page.$$eval('#environment-choices input', (all) => all.map((i) => i.value));
  assert.ok(names.length > 1);
  for (const name of names.slice(1)) {
    await changes(() => page.check(`#environment-choices input[value="${name}"]`));
    await page.screenshot({ path: resolve(screenshots, `${name}.png`) });
  }
  await changes(() => page.check(`#environment-choices input[value="${names[0]}"]`));
  await changes(() => page.fill('#exposure', '1.5'));
  assert.equal(await page.textContent('#exposure-value'), '+1.5 stops');
  await changes(() => page.click('#reset-exposure'));
  assert.equal(await pixels(page), original);
  checkMessages(messages);
  assert.deepEqual(errors, []);
  await close();
});

test('two pages of one session see one state', async () => {
  const one = await openPage('shared');
  const two = await openPage('shared');
  const frame = await frameOf(two.page);
  await drag(one.page, -150, 40);
  await one.page.fill('#exposure', '-1');
  await waitForExact(two.page, frame);
  await two.page.waitForFunction(
    () => document.getElementById('exposure-value').textContent.startsWith('−1.0'), undefined,
    { timeout: kPatience });
  await two.page.waitForTimeout(500);
  assert.equal(await pixels(one.page), await pixels(two.page));
  assert.ok(checkMessages(two.messages).has('state'));
  await one.close();
  await two.close();
});

test('touch turns the light, on a small screen', async () => {
  const { page, errors, close } = await openPage('touch',
    { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true, deviceScaleFactor: 3 });
  const before = await pixels(page);
  const frame = await frameOf(page);
  const box = await page.locator('#canvas').boundingBox();
  assert.ok(box.x >= 0 && box.x + box.width <= 390, 'the picture fits the screen');
  const client = await page.context().newCDPSession(page);
  const touch = (type, x) => client.send('Input.dispatchTouchEvent', {
    type, touchPoints: type === 'touchEnd' ? [] : [{ x, y: box.y + box.height / 2 }] });
  await touch('touchStart', box.x + 40);
  for (let i = 1; i <= 10; ++i) {
    await touch('touchMove', box.x + 40 + 15 * i);
    await page.waitForTimeout(16);
  }
  await touch('touchEnd');
  await waitForExact(page, frame);
  assert.notEqual(await pixels(page), before);
  await page.screenshot({ path: resolve(screenshots, 'phone.png') });
  assert.deepEqual(errors, []);
  await close();
});

test('the page says that the connection is lost, and comes back by itself', async () => {
  const own = await startServer();
  const context = await browser.newContext({ viewport: { width: 1280, height: 860 } });
  const page = await context.newPage();
  await page.goto(own.address);
  await waitForExact(page);
  await own.kill();
  await page.waitForFunction(
    () => document.getElementById('connection').textContent.includes('Reconnecting'), undefined,
    { timeout: kPatience });
  await page.screenshot({ path: resolve(screenshots, 'reconnecting.png') });
  const again = await startServer({ port: own.port });
  await page.waitForFunction(
    () => document.getElementById('connection').textContent === 'Connected', undefined,
    { timeout: kPatience });
  const frame = await frameOf(page);
  await drag(page, 120, 0);
  await page.waitForFunction((old) => Number(document.getElementById('canvas').dataset.frame) !== old,
    frame, { timeout: kPatience });
  await waitForExact(page);
  await context.close();
  const { code } = await again.stop();
  assert.equal(code, 0, 'a server that is asked to stop ends well');
});

test('nothing of the page comes from elsewhere', async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  const requests = [];
  page.on('request', (request) => requests.push(request.url()));
  await page.goto(server.address);
  await waitForExact(page);
  assert.ok(requests.length > 5);
  for (const url of requests) assert.ok(url.startsWith(server.address) || url.startsWith('blob:'), url);
  await context.close();
});

test('rimlight load checks the server, and its report fits the schema', async () => {
  const { code, stdout, stderr } = await run(['load', '--url', `ws://${server.host}`, '--clients',
    '2', '--seconds', '2', '--bake', bake, '--json']);
  const report = JSON.parse(stdout);
  assert.equal(faults('load_report', report), '');
  assert.equal(code, 0, stdout + stderr);
  assert.ok(report.checks.every((check) => check.pass === true), stdout);
  assert.ok(report.frames_per_second > 0);
});

test('rimlight load plays a light sequence to its end', async () => {
  const { code, stdout, stderr } = await run(['load', '--url', `ws://${server.host}`,
    '--sequence', resolve(root, 'configs/sequences/rotation.json'), '--bake', bake, '--json']);
  const report = JSON.parse(stdout);
  assert.equal(code, 0, stdout + stderr);
  assert.ok(report.checks.every((check) => check.pass === true), stdout);
  assert.ok(report.frames_per_second > 0);
});

test('the list of scenes fits its schema', async () => {
  const response = await fetch(`${server.address}api/scenes`);
  assert.equal(faults('scenes', await response.json()), '');
});

test('a busy port is an error that names it', async () => {
  const { code, stderr } = await run(['serve', bake, '--port', String(server.port)]);
  assert.equal(code, 1);
  assert.match(stderr, new RegExp(`127\\.0\\.0\\.1:${server.port}`));
});
