// The curve editor in a real browser, on a closed-form scene.
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import * as pages from './pages.js';
import { changes, checkMessages, kPatience, pixels, waitForExact } from './pages.js';
import { faults } from './schemas.js';
import { root, startCurveServer } from './server.js';

const screenshots = resolve(root, 'tests/e2e/screenshots');
let server;
let browser;

before(async () => {
  mkdirSync(screenshots, { recursive: true });
  server = await startCurveServer();
  browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox'] });
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

function openPage(session, options) {
  return pages.openPage(browser, `${server.address}?session=${session}`,
    { viewport: { width: 1280, height: 800 }, ...options });
}

function edits(messages) {
  return messages.filter((payload) => typeof payload === 'string').map((text) => JSON.parse(text))
    .filter(({ type }) => type === 'edit');
}

const points = (page) => page.locator('.curve-points circle');

async function centre(locator) {
  const box = await locator.boundingBox();
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
}

async function dragPoint(page, index, dx, dy) {
  const { x, y } = await centre(points(page).nth(index));
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= 10; ++i) {
    await page.mouse.move(x + (dx * i) / 10, y + (dy * i) / 10);
    await page.waitForTimeout(16);
  }
  await page.mouse.up();
}

test('a dragged point bends the curve, in one step that is undone and done again', async () => {
  const { page, errors, messages, close } = await openPage('drag');
  const original = await pixels(page);
  const before = await page.getAttribute('.curve-line.red', 'd');
  assert.equal(await points(page).count() > 3, true);
  await changes(page, () => dragPoint(page, 1, 15, 40));
  const bent = await pixels(page);
  assert.notEqual(await page.getAttribute('.curve-line.red', 'd'), before);
  await page.screenshot({ path: resolve(screenshots, 'curve_dragged.png') });
  const sent = edits(messages);
  assert.ok(sent.length > 2, 'it follows the hand');
  assert.ok(sent.every(({ material }) => material.curve.pearl.half_angle.points.length > 3));
  await changes(page, () => page.click('#curve-undo'));
  assert.equal(await pixels(page), original, 'one drag is one step');
  assert.equal(edits(messages).at(-1).material.curve.pearl.half_angle, null);
  assert.ok(await page.isDisabled('#curve-undo'));
  await changes(page, () => page.keyboard.press('Control+Shift+Z'));
  assert.equal(await pixels(page), bent);
  await changes(page, () => page.keyboard.press('Control+z'));
  assert.equal(await pixels(page), original);
  checkMessages(messages);
  assert.deepEqual(errors, []);
  await close();
});

test('points are added and removed by double clicks', async () => {
  const { page, errors, messages, close } = await openPage('points');
  const plot = await page.locator('#curve-plot').boundingBox();
  const count = await points(page).count();
  const added = { x: plot.x + 0.8 * plot.width, y: plot.y + 0.3 * plot.height };
  await changes(page, () => page.mouse.dblclick(added.x, added.y));
  assert.equal(await points(page).count(), count + 1);
  const index = await page.$$eval('.curve-points circle', (all) => all.indexOf(document.activeElement));
  assert.ok(index > 0, 'the new point has the focus');
  const { x, y } = await centre(points(page).nth(index));
  assert.ok(Math.hypot(x - added.x, y - added.y) < 4, 'it lies where it was put');
  await changes(page, () => page.mouse.dblclick(x, y));
  assert.equal(await points(page).count(), count);
  await changes(page, () => page.click('#curve-own'));
  assert.deepEqual(edits(messages).at(-1).material, { curve: { pearl: { half_angle: null } } });
  checkMessages(messages);
  assert.deepEqual(errors, []);
  await close();
});

test('keys do all that the mouse does', async () => {
  const { page, errors, messages, close } = await openPage('keys');
  await page.focus('#curve-compare');
  await page.keyboard.press('Tab');
  const focused = () => page.evaluate(() => ({ label: document.activeElement.getAttribute('aria-label'),
    role: document.activeElement.getAttribute('role'), text: document.activeElement.getAttribute('aria-valuetext'),
    width: getComputedStyle(document.activeElement).strokeWidth }));
  const first = await focused();
  assert.match(first.label, /^Point 1 of \d+$/);
  assert.equal(first.role, 'slider');
  assert.equal(first.width, '3px', 'the focus is seen');
  const valueOf = ({ text }) => Number(text.split(', ')[1]);
  await changes(page, async () => {
    await page.keyboard.press('ArrowDown');
    const small = await focused();
    assert.notEqual(small.text, first.text);
    await page.keyboard.press('Shift+ArrowDown');
    assert.ok(valueOf(small) / valueOf(await focused()) > valueOf(first) / valueOf(small), 'Shift moves farther');
    for (let i = 0; i < 4; ++i) await page.keyboard.press('Shift+ArrowDown'); // one step need not show in 8 bits
  });
  const count = await points(page).count();
  await page.keyboard.press('Tab');
  const [x] = [(await focused()).text];
  await page.keyboard.press('ArrowRight');
  assert.notEqual((await focused()).text, x);
  await page.keyboard.press('Enter');
  assert.equal(await points(page).count(), count + 1);
  await page.keyboard.press('Delete');
  assert.equal(await points(page).count(), count);
  assert.match((await focused()).label, /^Point \d+ of/, 'the focus stays in the plot');
  await page.waitForTimeout(300);
  assert.ok(edits(messages).every(({ rotation }) => rotation === undefined), 'the light does not turn');
  checkMessages(messages);
  assert.deepEqual(errors, []);
  await close();
});

test('one channel alone, and the scale of the curve', async () => {
  const { page, errors, messages, close } = await openPage('channels');
  await page.selectOption('#curve-channel', '2');
  await changes(page, () => dragPoint(page, 2, 0, 50));
  const { half_angle: blue } = edits(messages).at(-1).material.curve.pearl;
  assert.equal(blue.scale, 'logarithmic');
  assert.ok(blue.points[2][3] < 0.9 * blue.points[2][1]);
  assert.equal(blue.points[2][1], blue.points[2][2]);
  await page.selectOption('#curve-scale', 'linear');
  await page.waitForTimeout(200);
  const { half_angle: linear } = edits(messages).at(-1).material.curve.pearl;
  assert.equal(linear.scale, 'linear');
  assert.deepEqual(linear.points, blue.points);
  assert.deepEqual(errors, []);
  await close();
});

test('parameters, presets and the warning of too much energy', async () => {
  const { page, errors, messages, close } = await openPage('parameters');
  assert.equal(await page.isVisible('#curve-warning'), false);
  const before = await page.getAttribute('.curve-line.red', 'd');
  await changes(page, () => page.fill('#curve-roughness', '60'));
  const { roughness } = edits(messages).at(-1).material.parameter.pearl;
  assert.ok(roughness > 1e-4 && roughness < 0.3);
  assert.notEqual(await page.getAttribute('.curve-line.red', 'd'), before, 'the curve follows');
  await page.check('#curve-difference_angle', { force: true });
  await changes(page, () => page.fill('#curve-eta', '70'));
  for (const name of ['pearl', 'cloth', 'metal', 'satin']) {
    await changes(page, () => page.selectOption('#curve-preset', name));
    await page.check('#curve-half_angle', { force: true });
    await page.screenshot({ path: resolve(screenshots, `curve_${name}.png`) });
    assert.equal(await page.isVisible('#curve-warning'), false, name);
  }
  await page.check('#curve-difference_angle', { force: true });
  await page.selectOption('#curve-scale', 'linear');
  await page.focus('.curve-points circle');
  for (let i = 0; i < 10; ++i) await page.keyboard.press('Shift+ArrowUp');
  await page.waitForFunction(() => !document.getElementById('curve-warning').hidden, undefined, { timeout: kPatience });
  assert.match(await page.textContent('#curve-energy'), /up to \d{3} %/);
  await page.screenshot({ path: resolve(screenshots, 'curve_warning.png') });
  await changes(page, () => page.click('#curve-reset'));
  assert.equal(await page.isVisible('#curve-warning'), false);
  assert.deepEqual(edits(messages).at(-1).material, { parameter: { pearl: null } });
  checkMessages(messages);
  assert.deepEqual(errors, []);
  await close();
});

test('other models have their own parameters, and a measured BRDF takes their place', async () => {
  const { page, errors, messages, close } = await openPage('load');
  const original = await pixels(page);
  await page.selectOption('#curve-material', 'brushed');
  assert.equal(await page.isVisible('#curve-plot'), false, 'no factor to draw');
  await changes(page, () => page.fill('#curve-roughness_across', '90'));
  await changes(page, () => page.selectOption('#curve-load', 'gold'));
  await page.waitForSelector('#curve-plot', { state: 'visible' });
  await page.waitForFunction(() => document.querySelectorAll('.curve-points circle').length > 3, undefined,
    { timeout: kPatience });
  assert.equal(await page.textContent('#curve-fit'), 'Fitted to 7.0 %');
  assert.equal(await page.isVisible('#curve-roughness'), false);
  await changes(page, () => dragPoint(page, 1, 0, 60));
  await page.screenshot({ path: resolve(screenshots, 'curve_measured.png') });
  for (let i = 0; i < 3; ++i) await page.click('#curve-undo');
  await page.waitForTimeout(400);
  await waitForExact(page);
  assert.equal(await pixels(page), original);
  await page.selectOption('#curve-material', 'red & blue');
  assert.equal(await page.isDisabled('#curve-difference_angle'), true);
  await page.selectOption('#curve-compare', 'measured gold');
  await page.waitForFunction(() => document.querySelector('.curve-compare.red').getAttribute('d') !== '',
    undefined, { timeout: kPatience });
  await page.screenshot({ path: resolve(screenshots, 'curve_compare.png') });
  checkMessages(messages);
  assert.deepEqual(errors, []);
  await close();
});

test('what others draw is seen, on a narrow window too', async () => {
  const one = await openPage('shared');
  const two = await openPage('shared',
    { viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 });
  const before = await two.page.getAttribute('.curve-line.red', 'd');
  await dragPoint(one.page, 1, 20, 30);
  await two.page.waitForFunction(
    (old) => document.querySelector('.curve-line.red').getAttribute('d') !== old, before, { timeout: kPatience });
  await two.page.waitForTimeout(400);
  assert.equal(await two.page.getAttribute('.curve-line.red', 'd'), await one.page.getAttribute('.curve-line.red', 'd'));
  const width = await two.page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(width <= 390, `nothing runs off the side: ${width}`);
  await two.page.screenshot({ path: resolve(screenshots, 'curve_phone.png'), fullPage: true });
  for (const id of ['#curve-plot', '#curve-reset', '#canvas']) {
    await two.page.locator(id).scrollIntoViewIfNeeded();
    assert.ok(await two.page.isVisible(id), id);
  }
  assert.ok(checkMessages(two.messages).has('state'));
  assert.deepEqual([...one.errors, ...two.errors], []);
  await one.close();
  await two.close();
});

test('at 1280 × 800 the picture and the whole editor fit', async () => {
  const { page, close } = await openPage('layout');
  const canvas = await page.locator('#canvas').boundingBox();
  const plot = await page.locator('#curve-plot').boundingBox();
  assert.ok(canvas.width >= 500, String(canvas.width));
  assert.ok(plot.x >= canvas.x + canvas.width && plot.x + plot.width <= 1280);
  const hidden = await page.$eval('#curves', (panel) => panel.scrollHeight - panel.clientHeight);
  assert.ok(hidden <= 0, `${hidden} pixels of it are out of sight`);
  await close();
});

test('scenes without editable BRDFs have no panel', async () => {
  const { page, errors, close } = await pages.openPage(browser, `${server.address}?session=none&scene=sphere`);
  assert.equal(await page.isVisible('#curves'), false);
  assert.deepEqual(errors, []);
  await close();
});

test('the curves of materials fit their schema, and unknown names get an error', async () => {
  const get = (query) => fetch(`${server.address}api/curves?${new URLSearchParams(query)}`);
  for (const query of [{ scene: 'curves', material: 'pearl' }, { material: 'red & blue' },
    { material: 'brushed', measured: 'gold' }]) {
    const response = await get(query);
    assert.equal(response.status, 200);
    assert.equal(faults('curves', await response.json()), '');
  }
  const unknown = await get({ material: 'iron' });
  assert.equal(unknown.status, 404);
  assert.equal(faults('error', await unknown.json()), '');
});
