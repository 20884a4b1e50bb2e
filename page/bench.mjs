#!/usr/bin/env node
// How fast the page is: from a server's sending of a state to its picture on the screen, frames a second of the waterfall,
// and what is fetched, compressed.  page/bench.mjs [--page FOLDER] [--changes N]
//
// Server and browser run on one host and so on one clock. A state counts as painted when the browser calls for the frame
// after the one that changed the text: by then that one is handed over for display.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { parseArgs } from 'node:util';
import { gzipSync } from 'node:zlib';
import { built, launch, open, waitForText } from './test/browser.mjs';
import { startServer } from './test/mock_server.mjs';

const { values } = parseArgs({ options: { page: { type: 'string', default: built }, changes: { type: 'string', default: '200' } } });
const folder = values.page;
const files = readdirSync(folder, { recursive: true, withFileTypes: true }).filter((f) => f.isFile() && f.name !== 'uplot-licence.txt')
  .map((f) => join(f.parentPath ?? f.path, f.name));
const size = files.reduce((sum, f) => sum + gzipSync(readFileSync(f), { level: 9 }).length, 0);
console.log(`size compressed (gzip -9)      ${(size / 1000).toFixed(1)} kB in ${files.length} files`);

const server = await startServer({ page: folder, at: 14 });
const browser = await launch();
for (const [width, height] of [[1366, 768], [1920, 1080]]) {
  const page = await open(browser, server.url, { viewport: { width, height } });
  await waitForText(page, 'stages', /decision/);
  await page.waitForTimeout(3000);

  const frames = await page.evaluate(async () => {
    const canvas = document.getElementById('waterfall');
    const [from, began] = [Number(canvas.dataset.frames), performance.now()];
    let [longest, last] = [0, began];
    while (last - began < 5000) {
      await new Promise(requestAnimationFrame);
      const now = performance.now();
      [longest, last] = [Math.max(longest, now - last), now];
    }
    return { rate: (1000 * (Number(canvas.dataset.frames) - from)) / (last - began), longest };
  });
  console.log(`${width} × ${height}: waterfall          ${frames.rate.toFixed(1)} frames/s, longest pause ${frames.longest.toFixed(0)} ms`);

  await page.evaluate(() => {
    window.painted = {};
    new MutationObserver(() => {
      const text = document.getElementById('state-reason').textContent;
      requestAnimationFrame(() => { window.painted[text] ??= performance.timeOrigin + performance.now(); });
    }).observe(document.getElementById('state-reason'), { childList: true, characterData: true, subtree: true });
  });
  const sent = new Map();
  for (let i = 0; i < Number(values.changes); i++) {
    const reason = `Change ${i}`;
    sent.set(reason, Date.now());
    server.hold({ state: i % 2 ? 'chatter' : 'stable', reason });
    await new Promise((resolve) => setTimeout(resolve, 40 + ((i * 7) % 23)));
  }
  await page.waitForTimeout(500);
  const painted = await page.evaluate(() => window.painted);
  const delays = [...sent].map(([reason, at]) => painted[reason] - at).filter(Number.isFinite).sort((a, b) => a - b);
  const at = (share) => delays[Math.min(delays.length - 1, Math.floor(share * delays.length))].toFixed(0);
  console.log(`${width} × ${height}: state to picture   p50 ${at(0.5)} ms, p99 ${at(0.99)} ms, worst ${at(1)} ms of ${delays.length} changes (${sent.size - delays.length} overtaken)`);
  server.hold(null);
  await page.context().close();
}
await browser.close();
await server.stop();
