// Curves of a real bake, from the page and from scripted clients.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import * as pages from './pages.js';
import { changes, checkMessages, drag, pixels } from './pages.js';
import { curveBake, root, run, startServer } from './server.js';

const screenshots = resolve(root, 'tests/e2e/screenshots');
let server;
let browser;

before(async () => {
  mkdirSync(screenshots, { recursive: true });
  server = await startServer({ bakes: [curveBake] });
  browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox'] });
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

const points = (page) => page.locator('.curve-points circle');

async function dragPoint(page, index, dx, dy) {
  const box = await points(page).nth(index).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= 10; ++i) {
    await page.mouse.move(x + (dx * i) / 10, y + (dy * i) / 10);
    await page.waitForTimeout(16);
  }
  await page.mouse.up();
}

test('a curve is bent, the light turned, the curve taken back: exact each time', async () => {
  const { page, errors, messages, close } = await pages.openPage(browser,
    `${server.address}?session=bend`, { viewport: { width: 1280, height: 860 } });
  const original = await pixels(page);
  assert.ok(await page.isVisible('#curves'));
  await changes(page, () => dragPoint(page, 1, 20, -30));
  assert.match(await page.textContent('#quality'), /other surfaces/);
  await page.screenshot({ path: resolve(screenshots, 'curve_bake.png') });
  const bent = await pixels(page);
  await changes(page, () => drag(page, 60, 10));
  await changes(page, () => page.click('#reset-rotation'));
  assert.equal(await pixels(page), bent, 'the same light shows the same curve');
  await changes(page, () => page.click('#curve-reset'));
  assert.equal(await pixels(page), original);
  assert.ok(checkMessages(messages).has('frame'));
  assert.deepEqual(errors, []);
  await close();
});

test('rimlight load bends curves while the light turns, and ends with what render shows', async () => {
  const edits = [];
  for (let i = 0; i < 90; ++i) {
    const angle = 0.02 + i / 60;
    const half = { scale: 'linear', points: [[0.1, 1 + i / 9, 2, 1], [0.5, 0.5, 0.1, 0.2], [0.9, 0, 0, 0]] };
    edits.push(i % 3 === 0
      ? { at_ms: (1000 * i) / 60, rotation: [0, Math.sin(angle / 2), 0, Math.cos(angle / 2)] }
      : { at_ms: (1000 * i) / 60, material: { curve: { clay: { half_angle: half } } } });
  }
  const folder = mkdtempSync(join(tmpdir(), 'rimlight-curves-'));
  try {
    const script = join(folder, 'script.json');
    writeFileSync(script, JSON.stringify({ edits }));
    const { code, stdout, stderr } = await run(['load', '--url', `ws://${server.host}`, '--clients', '2',
      '--seconds', '1.6', '--script', script, '--bake', curveBake, '--json']);
    assert.equal(code, 0, stdout + stderr);
    const { checks } = JSON.parse(stdout);
    assert.ok(checks.every(({ pass }) => pass === true), stdout);
  } finally {
    rmSync(folder, { recursive: true });
  }
});

test('curves that are none, and materials that are not there, get an error', async () => {
  const { page, close } = await pages.openPage(browser, `${server.address}?session=bad`);
  const original = await pixels(page);
  const answers = await page.evaluate(async () => {
    const socket = new WebSocket(`ws://${location.host}/sessions/bad/stream`);
    const seen = [];
    await new Promise((opened) => { socket.onopen = opened; });
    const ask = (material) => new Promise((answered) => {
      socket.onmessage = ({ data }) => {
        if (typeof data !== 'string') return;
        const message = JSON.parse(data);
        if (message.type === 'error' || message.type === 'ack') answered(message);
      };
      socket.send(JSON.stringify({ type: 'edit', id: 'x', material }));
    });
    const bins = (count) => Array.from({ length: count }, () => [1, 1, 1]);
    seen.push(await ask({ curve: { clay: { half_angle: { values: bins(257) } } } }));
    seen.push(await ask({ curve: { gold: { half_angle: { values: bins(256) } } } }));
    seen.push(await ask({ curve: { clay: { half_angle: { scale: 'linear', points: [[0.5, 1, 1, 1], [0.4, 1, 1, 1]] } } } }));
    seen.push(await ask({ load: { clay: 'velvet' } }));
    seen.push(await ask({ parameter: { clay: { roughness: 0 } } }));
    socket.close();
    return seen;
  });
  assert.deepEqual(answers.map(({ type }) => type), Array(5).fill('error'));
  assert.equal(await pixels(page), original);
  await close();
});
