// What tests do with pages of the server.
import assert from 'node:assert/strict';
import { faults } from './schemas.js';

export const kPatience = 20000;

/**
 * A page with everything that went wrong in it, and every message that went over its socket; `init` runs in it before its
 * own scripts.
 */
export async function openPage(browser, url, { init, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 860 }, ...options });
  if (init) await context.addInitScript(init);
  const page = await context.newPage();
  const errors = [];
  const messages = [];
  page.on('pageerror', (error) => errors.push(String(error)));
  page.on('console', (line) => { if (line.type() === 'error') errors.push(line.text()); });
  page.on('websocket', (socket) => {
    socket.on('framesent', ({ payload }) => messages.push(payload));
    socket.on('framereceived', ({ payload }) => messages.push(payload));
  });
  await page.goto(url);
  await waitForExact(page);
  return { page, errors, messages, close: () => context.close() };
}

export function frameOf(page) {
  return page.$eval('#canvas', (canvas) => Number(canvas.dataset.frame ?? -1));
}

/** Waits for an exact frame that shows all edits of the page. */
export async function waitForExact(page, after = -1) {
  await page.waitForFunction((least) => {
    const canvas = document.getElementById('canvas');
    return canvas.ariaBusy === 'false' && Number(canvas.dataset.frame) > least;
  }, after, { timeout: kPatience });
}

/** A short text that stands for the pixels of the canvas, to compare. */
export function pixels(page) {
  return page.$eval('#canvas', async (canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const digest = new Uint8Array(await crypto.subtle.digest('SHA-256', data));
    return Array.from(digest, (byte) => byte.toString(16).padStart(2, '0')).join('');
  });
}

/** Does something that must change the exact picture. */
export async function changes(page, act) {
  await waitForExact(page);
  const [frame, old] = [await frameOf(page), await pixels(page)];
  await act();
  await waitForExact(page, frame);
  assert.notEqual(await pixels(page), old);
}

export async function drag(page, dx, dy, { steps = 20, button = 'left' } = {}) {
  const box = await page.locator('#canvas').boundingBox();
  const x = box.x + box.width / 2;
  const y = box.y + box.height / 2;
  await page.mouse.move(x, y);
  await page.mouse.down({ button });
  for (let i = 1; i <= steps; ++i) {
    await page.mouse.move(x + (dx * i) / steps, y + (dy * i) / steps);
    await page.waitForTimeout(16);
  }
  await page.mouse.up({ button });
}

/** Every message that went over the sockets fits its schema. */
export function checkMessages(messages) {
  const kinds = new Set();
  for (const payload of messages) {
    if (typeof payload === 'string') {
      const message = JSON.parse(payload);
      assert.equal(faults(message.type, message), '');
      kinds.add(message.type);
    } else {
      const length = payload.readUInt32LE(0);
      assert.equal(faults('frame_header', JSON.parse(payload.toString('utf8', 4, 4 + length))), '');
      kinds.add('frame');
    }
  }
  return kinds;
}
