// How frames come to the page: VP8 through WebCodecs, JPEG where it cannot, hidden tabs, parts.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';
import * as pages from './pages.js';
import { checkMessages, drag, frameOf, waitForExact } from './pages.js';
import { run, startServer } from './server.js';
import { faults } from './schemas.js';

let server;
let browser;
let hasVp8;

before(async () => {
  server = await startServer();
  browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox'] });
  const { stdout } = await run(['--version']);
  hasVp8 = !stdout.includes('without VP8');
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

function headersOf(messages) {
  return messages.filter((payload) => typeof payload !== 'string').map((payload) => {
    const length = payload.readUInt32LE(0);
    return JSON.parse(payload.toString('utf8', 4, 4 + length));
  });
}

function displaysOf(messages) {
  return messages.filter((payload) => typeof payload === 'string').map((text) => JSON.parse(text))
    .filter((message) => message.type === 'display');
}

function openPage(session, { query = '', init } = {}) {
  return pages.openPage(browser, `${server.address}?session=${session}${query}`, { init });
}

/** PSNR in dB of each frame in motion that the page drew against the exact one of its revision. */
const keepPictures = () => {
  const draw = CanvasRenderingContext2D.prototype.drawImage;
  window.drawn = [];
  CanvasRenderingContext2D.prototype.drawImage = function keep(...args) {
    draw.apply(this, args);
    window.drawn.push({ kind: args[0].constructor.name,
      pixels: this.getImageData(0, 0, this.canvas.width, this.canvas.height).data });
  };
  window.psnrOfLastTwo = () => {
    const [moving, exact] = window.drawn.slice(-2);
    let sum = 0;
    for (let i = 0; i < exact.pixels.length; ++i) sum += (moving.pixels[i] - exact.pixels[i]) ** 2;
    return { kind: moving.kind, psnr: 10 * Math.log10((255 * 255 * exact.pixels.length) / sum) };
  };
};

test('the page decodes VP8 to nearly the exact picture, and JPEG where it is asked to', async (t) => {
  const found = {};
  for (const [name, query] of [['vp8', ''], ['jpeg', '&codec=jpeg']]) {
    const { page, errors, messages, close } = await openPage(`codec-${name}`, { query, init: keepPictures });
    const first = await frameOf(page);
    await drag(page, 200, 40);
    await waitForExact(page, first);
    const moving = headersOf(messages).filter((header) => !header.exact);
    const expected = hasVp8 ? name : 'jpeg';
    assert.ok(moving.length > 5, `${moving.length} frames`);
    assert.ok(moving.every((header) => header.codec === expected || header.frame < first + 2), name);
    if (expected === 'vp8') {
      // A slow machine may climb the ladder: each rung's stream begins with a key frame.
      const keys = moving.filter((header) => header.key).length;
      const begun = moving.filter((header, i) => i === 0 || header.rung !== moving[i - 1].rung).length;
      assert.ok(keys >= 1 && keys <= begun, `${keys} key frames, ${begun} streams begun`);
      assert.match(await page.evaluate(() => window.drawn.at(-2).kind), /VideoFrame/);
    }
    found[name] = await page.evaluate(() => window.psnrOfLastTwo());
    assert.match(await page.textContent('#stat-frame'), /^PNG, 128 × 128, [\d.]+ KB$/);
    const kinds = checkMessages(messages);
    assert.ok(kinds.has('display'));
    assert.deepEqual(errors, []);
    await close();
  }
  t.diagnostic(JSON.stringify(found));
  // Both are of frames in motion, whose light is approximate too.
  assert.ok(found.vp8.psnr > 30, JSON.stringify(found));
  assert.ok(found.vp8.psnr > found.jpeg.psnr - 3, JSON.stringify(found));
});

test('a page whose decoder fails says so and goes on with JPEG', async (t) => {
  if (!hasVp8) return t.skip('a server without VP8');
  const { page, errors, messages, close } = await openPage('fallback', { init: () => {
    let frames = 0;
    const decode = VideoDecoder.prototype.decode;
    VideoDecoder.prototype.decode = function fail(chunk) {
      frames += 1;
      const bytes = new Uint8Array(chunk.byteLength);
      chunk.copyTo(bytes);
      if (frames === 4) bytes.fill(0xff);
      decode.call(this, new EncodedVideoChunk({ type: chunk.type, timestamp: chunk.timestamp, data: bytes }));
    };
  } });
  const first = await frameOf(page);
  await drag(page, 150, 30);
  await waitForExact(page, first);
  // Small looks at an exact picture, which come before its parts, are JPEG.
  const moving = headersOf(messages).filter((header) => !header.exact && header.frame > first);
  assert.ok(moving.some((header) => header.codec === 'vp8'));
  assert.equal(moving.at(-1).codec, 'jpeg');
  const said = displaysOf(messages);
  assert.ok(said[0].codecs.includes('vp8'));
  assert.ok(!said.at(-1).codecs.includes('vp8'));
  assert.deepEqual(errors, []);
  await close();
});

test('without WebCodecs the page gets JPEG', async () => {
  const { page, errors, messages, close } = await openPage('plain', { init: () => { delete window.VideoDecoder; } });
  const first = await frameOf(page);
  await drag(page, 100, 30);
  await waitForExact(page, first);
  const moving = headersOf(messages).filter((header) => !header.exact);
  assert.ok(moving.length > 0 && moving.every((header) => header.codec === 'jpeg'));
  assert.deepEqual(errors, []);
  await close();
});

test('a hidden tab gets no frames, and the newest exact one when it comes back', async () => {
  const hide = () => {
    let hidden = false;
    Object.defineProperty(Document.prototype, 'hidden', { get: () => hidden });
    window.setHidden = (value) => { hidden = value; document.dispatchEvent(new Event('visibilitychange')); };
  };
  const tab = await openPage('hidden', { init: hide });
  const other = await openPage('hidden');
  await tab.page.evaluate(() => window.setHidden(true));
  await tab.page.waitForTimeout(200);
  const before = headersOf(tab.messages).length;
  const frame = await frameOf(other.page);
  await drag(other.page, 120, 20);
  await waitForExact(other.page, frame);
  assert.equal(headersOf(tab.messages).length, before, 'no frames while it is hidden');
  const shown = await frameOf(tab.page);
  await tab.page.evaluate(() => window.setHidden(false));
  await waitForExact(tab.page, shown);
  const headers = headersOf(tab.messages);
  assert.equal(headers.length, before + 1);
  assert.equal(headers.at(-1).revision, headersOf(other.messages).at(-1).revision);
  checkMessages(tab.messages);
  await tab.close();
  await other.close();
});

test('rimlight load decodes VP8, and a narrow link is reported apart', async (t) => {
  const codec = hasVp8 ? 'vp8' : 'jpeg';
  const { code, stdout, stderr } = await run(['load', '--url', `ws://${server.host}`, '--clients', '2',
    '--seconds', '2', '--codec', codec, '--shared-session', '--slow-kBps', '20', '--json']);
  const report = JSON.parse(stdout);
  assert.equal(faults('load_report', report), '');
  assert.equal(code, 0, stdout + stderr);
  assert.ok(report.rungs.some((rung) => rung.codec === codec && rung.frames > 20), stdout);
  assert.ok(report.slow.rungs.length > 0, stdout);
  t.diagnostic(JSON.stringify(report.rungs));
});
