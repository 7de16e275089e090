// Undo on the page, who is there, snapshots, files, and coming back.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import { importOf, peopleText, shortcut } from '../../web/js/session_tools.js';
import * as pages from './pages.js';
import { changes, checkMessages, drag, kPatience, pixels, waitForExact } from './pages.js';
import { root, run, startServer } from './server.js';

const screenshots = resolve(root, 'tests/e2e/screenshots');
let folder;
let server;
let browser;

before(async () => {
  mkdirSync(screenshots, { recursive: true });
  folder = mkdtempSync(join(tmpdir(), 'rimlight-'));
  server = await startServer({ more: ['--store', join(folder, 'sessions.sqlite')] });
  browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox'] });
});

after(async () => {
  await browser?.close();
  await server?.stop();
  rmSync(folder, { recursive: true, force: true });
});

function openPage(session, options) {
  return pages.openPage(browser, `${server.address}?session=${session}`, options);
}
const hasText = (page, id, text) => page.waitForFunction(
  ([name, part]) => document.getElementById(name).textContent.includes(part), [id, text], { timeout: kPatience });

test('a drag is undone by the keyboard as one step, among what another page does', async () => {
  const one = await openPage('undo');
  const two = await openPage('undo');
  const original = await pixels(one.page);
  await drag(one.page, 200, 30);
  await waitForExact(one.page);
  await one.page.keyboard.press('Control+z');
  await waitForExact(one.page);
  assert.equal(await pixels(one.page), original);
  await one.page.keyboard.press('Control+Shift+Z');
  await waitForExact(one.page);
  const turned = await pixels(one.page);
  assert.notEqual(turned, original);
  await changes(two.page, () => two.page.fill('#exposure', '1'));
  assert.ok(await one.page.isEnabled('#undo'));
  await changes(one.page, () => one.page.click('#undo'));
  assert.equal(await one.page.textContent('#exposure-value'), '+1.0 stops', 'what the other did stays');
  assert.ok(await one.page.isDisabled('#undo'));
  assert.ok(await two.page.isEnabled('#undo'));
  await changes(two.page, () => two.page.keyboard.press('Control+z'));
  await waitForExact(one.page);
  await one.page.waitForFunction(() => document.getElementById('exposure-value').textContent.startsWith('0.0'));
  assert.equal(await pixels(two.page), original);
  for (const { messages, errors } of [one, two]) {
    checkMessages(messages);
    assert.deepEqual(errors, []);
  }
  assert.ok(checkMessages(one.messages).has('undo'));
  await one.close();
  await two.close();
});

test('the page says who is there and who changed something last', async () => {
  const one = await openPage('people');
  await hasText(one.page, 'people', 'guest 1 (you)');
  const two = await openPage('people');
  await hasText(one.page, 'people', 'guest 1 (you), guest 2');
  await changes(two.page, () => two.page.fill('#exposure', '1'));
  await hasText(one.page, 'last-change', 'guest 2');
  await hasText(two.page, 'last-change', 'you');
  await two.close();
  await one.page.waitForFunction(() => document.getElementById('people').textContent === 'guest 1 (you)',
    undefined, { timeout: kPatience });
  assert.ok(checkMessages(one.messages).has('presence'));
  await one.close();
});

test('a snapshot is saved, restored and deleted with the keyboard', async () => {
  const { page, errors, messages, close } = await openPage('snapshots');
  const original = await pixels(page);
  await page.focus('#snapshots summary');
  await page.keyboard.press('Enter');
  await page.focus('#snapshot-name');
  await page.keyboard.type('morning');
  await page.keyboard.press('Enter');
  await page.waitForSelector('#snapshot-list li', { timeout: kPatience });
  await page.screenshot({ path: resolve(screenshots, 'snapshots.png') });
  await changes(page, () => page.fill('#exposure', '2'));
  const bright = await pixels(page);
  await changes(page, () => page.press('#snapshot-list button:has-text("Restore")', 'Enter'));
  assert.equal(await pixels(page), original);
  await changes(page, () => page.click('#undo'));
  assert.equal(await pixels(page), bright);
  await page.press('button[aria-label="Delete morning"]', 'Enter');
  await page.press('button[aria-label="Delete morning"]', 'Enter');
  await page.waitForSelector('#snapshot-none', { state: 'visible', timeout: kPatience });
  await page.focus('#snapshot-name');
  await page.keyboard.press('Escape');
  assert.equal(await page.isVisible('#snapshot-name'), false);
  const kinds = checkMessages(messages);
  for (const kind of ['snapshot', 'snapshots', 'undo', 'ack']) assert.ok(kinds.has(kind), kind);
  assert.deepEqual(errors, []);
  await close();
});

test('the state goes to a file and comes back from it', async () => {
  const { page, errors, messages, close } = await openPage('files');
  const original = await pixels(page);
  await changes(page, () => page.fill('#exposure', '1.5'));
  const bright = await pixels(page);
  await page.click('#snapshots summary');
  const [saved] = await Promise.all([page.waitForEvent('download'), page.click('#export-state')]);
  const file = join(folder, 'exported.json');
  await saved.saveAs(file);
  assert.equal(saved.suggestedFilename(), 'files.json');
  assert.equal(JSON.parse(readFileSync(file, 'utf8')).state.exposure, 1.5);
  await changes(page, () => page.click('#undo'));
  assert.equal(await pixels(page), original);
  await changes(page, () => page.setInputFiles('#import-file', file));
  assert.equal(await pixels(page), bright);
  await changes(page, () => page.click('#undo'));
  assert.equal(await pixels(page), original);
  const wrong = join(folder, 'wrong.json');
  writeFileSync(wrong, '{"state": {"exposure": 99}}');
  await page.setInputFiles('#import-file', wrong);
  await page.waitForSelector('.toast', { timeout: kPatience });
  checkMessages(messages.filter((one) => typeof one !== 'string' || !one.includes('"exposure":99')));
  assert.deepEqual(errors, []);
  await close();
});

test('a page that is loaded again is the same user with the same steps', async () => {
  const { page, errors, messages, close } = await openPage('reload');
  const original = await pixels(page);
  await changes(page, () => page.fill('#exposure', '1'));
  await page.reload();
  await waitForExact(page);
  assert.equal(await page.textContent('#people'), 'guest 1 (you)');
  await changes(page, () => page.keyboard.press('Control+z'));
  assert.equal(await pixels(page), original);
  const welcomes = messages.filter((one) => typeof one === 'string' && one.includes('"welcome"'))
    .map((one) => JSON.parse(one));
  assert.deepEqual(welcomes.map(({ resumed, you }) => [resumed, you.id]), [[false, 1], [true, 1]]);
  assert.equal(await page.evaluate(() => document.cookie + location.href).then((text) => text.includes(welcomes[0].resume)), false);
  assert.deepEqual(errors, []);
  await close();
});

test('after kill -9 the page comes back by itself and undoes what it did', async () => {
  const { page, close } = await openPage('killed');
  const original = await pixels(page);
  await changes(page, () => page.fill('#exposure', '1'));
  const { port } = server;
  await server.kill();
  await page.waitForSelector('#connection[data-state="waiting"]', { timeout: kPatience });
  server = await startServer({ port, more: ['--store', join(folder, 'sessions.sqlite')] });
  await page.waitForSelector('#connection[data-state="open"]', { timeout: kPatience });
  await waitForExact(page);
  assert.equal(await page.textContent('#people'), 'guest 1 (you)');
  await changes(page, () => page.keyboard.press('Control+z'));
  assert.equal(await pixels(page), original);
  await close();
});

test('a viewer sees everything, is told why nothing can be changed, and changes nothing', async () => {
  const keys = join(folder, 'keys.json');
  await run(['token', '--new-key', keys]);
  const closed = await startServer({ more: ['--key', keys] });
  const token = async (role, name) => (await run(
    ['token', '--key', keys, '--role', role, '--session', 'default', '--name', name])).stdout.trim();
  const owner = await pages.openPage(browser, `${closed.address}#token=${await token('owner', 'Olga')}`);
  const viewer = await pages.openPage(browser, `${closed.address}#token=${await token('viewer', 'Vera')}`);
  const { page } = viewer;
  await hasText(page, 'people', 'Olga, Vera (you)');
  assert.ok(await page.isVisible('#watching'));
  assert.equal(await owner.page.isVisible('#watching'), false);
  for (const id of ['#undo', '#redo', '#reset-rotation', '#reset-exposure', '#snapshot-save', '#import-state']) {
    assert.ok(await page.isDisabled(id), id);
  }
  assert.equal(await page.$eval('#environments', (part) => part.inert), true);
  await page.screenshot({ path: resolve(screenshots, 'viewer.png') });
  const before = await pixels(page);
  await drag(page, 150, 20);
  await page.keyboard.press('Control+z');
  await page.waitForTimeout(200);
  assert.equal(await pixels(page), before);
  assert.equal(viewer.messages.some((one) => typeof one === 'string' && one.includes('"edit"')), false);
  await changes(page, () => owner.page.fill('#exposure', '1'));
  await hasText(page, 'last-change', 'Olga');
  assert.deepEqual(viewer.errors, []);
  await viewer.close();
  await owner.close();
  await closed.stop();
});

test('names, keys and files are read as they are meant', () => {
  assert.equal(peopleText([{ id: 1, name: 'Ann' }, { id: 2, name: 'Bo' }], 3, { id: 2 }), 'Ann, Bo (you), 3 more');
  const key = (text, more = {}) => shortcut({ key: text, ctrlKey: true, ...more });
  assert.equal(key('z'), 'undo');
  assert.equal(key('Z', { shiftKey: true }), 'redo');
  assert.equal(key('y'), 'redo');
  assert.equal(key('z', { ctrlKey: false, metaKey: true }), 'undo');
  assert.equal(key('z', { ctrlKey: false }), null);
  assert.equal(key('z', { altKey: true }), null);
  assert.equal(key('z', { target: { matches: () => true } }), null);
  assert.deepEqual(importOf('{"state": {"a": 1}, "scene": "b"}'), { type: 'import', state: { a: 1 } });
  assert.throws(() => importOf('{'), /no JSON/);
  assert.throws(() => importOf('{"state": null}'), /no state/);
  assert.equal(importOf(JSON.stringify({ state: { a: 'x'.repeat(70000) } })), null); // by PUT
});
