#!/usr/bin/env node
// How late the page is on a live cell: from the newest sample that a change of state rests on to its picture.
// page/bench_live.mjs [BUILD] [--cuts N]: daemon, simulated machine, server and browser on this host, so on one clock.
import { execFileSync, spawn } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { launch, open } from './test/browser.mjs';

const { values, positionals } = parseArgs({ options: { cuts: { type: 'string', default: '5' } }, allowPositionals: true });
const root = resolve(fileURLToPath(import.meta.url), '../..');
const programs = resolve(positionals[0] ?? join(root, 'build'));
const scenario = join(root, 'examples/scenarios/depth-step.toml');
const folder = mkdtempSync(join(tmpdir(), 'stillcut-bench.'));
cpSync(join(root, 'examples/demo-cell'), folder, { recursive: true });
const cell = join(folder, 'cell.toml');
const text = readFileSync(cell, 'utf8').replace(/^bus = .*$/m, 'bus = "local:stillcut-bench-live"').replace('"shadow"', '"active"');
writeFileSync(cell, `${text}\n[lcm]\nurl = "udpm://239.255.76.67:7696?ttl=0"\n`);

const server = spawn(join(programs, 'stillcut'), ['scope', cell, '--port', '0', '--json'], { stdio: ['ignore', 'pipe', 'inherit'] });
const url = await new Promise((found) => server.stdout.once('data', (line) => found(JSON.parse(line).url)));
const sent = []; // changes of state as the server tells them: {state, t}
const stream = new AbortController();
(async () => {
  const answer = await fetch(`${url}api/stream`, { signal: stream.signal });
  let rest = '';
  for await (const chunk of answer.body.pipeThrough(new TextDecoderStream())) {
    const blocks = (rest + chunk).split('\n\n');
    rest = blocks.pop();
    for (const block of blocks) {
      const data = /^event: state\ndata: (.*)$/s.exec(block)?.[1];
      const state = data && JSON.parse(data);
      if (state && state.state !== sent.at(-1)?.state) sent.push({ state: state.state, t: state.t });
    }
  }
})().catch((error) => { if (error.name !== 'AbortError') throw error; });

const browser = await launch();
const page = await open(browser, url);
await page.waitForTimeout(2000);
await page.evaluate(() => {
  window.painted = [];
  const word = document.getElementById('state-word');
  new MutationObserver(() => {
    const state = word.textContent.toLowerCase();
    requestAnimationFrame(() => window.painted.push({ state, at: (performance.timeOrigin + performance.now()) / 1000 }));
  }).observe(word, { childList: true, characterData: true, subtree: true });
});
const processorS = () => {
  const fields = readFileSync(`/proc/${server.pid}/stat`, 'utf8').split(') ')[1].split(' ');
  return (Number(fields[11]) + Number(fields[12])) / 100;
};
const [busy, began] = [processorS(), Date.now()];
for (let cut = 0; cut < Number(values.cuts); cut++) {
  const daemon = spawn(join(programs, 'stillcutd'), [cell, '--allow-not-real-time'], { stdio: 'ignore' });
  execFileSync(join(programs, 'stillcut'), ['plant', cell, '--scenario', scenario], { stdio: 'ignore' });
  daemon.kill();
  await new Promise((ended) => daemon.once('exit', ended));
}
const share = (processorS() - busy) / ((Date.now() - began) / 1000);
const painted = await page.evaluate(() => window.painted);
stream.abort();
await browser.close();
server.kill();
rmSync(folder, { recursive: true });

// 'no daemon' rests on no sample.
const delays = sent.filter(({ state }) => state !== 'no daemon').map(({ state, t }) =>
  painted.find((p) => p.state === state && p.at >= t && p.at < t + 1)?.at - t);
const found = delays.filter(Number.isFinite).sort((a, b) => a - b);
const ms = (share) => (1000 * found[Math.min(found.length - 1, Math.floor(share * found.length))]).toFixed(0);
console.log(`sample to picture   p50 ${ms(0.5)} ms, worst ${ms(1)} ms of ${found.length} changes of state (${delays.length - found.length} replaced before they were painted)`);
console.log(`the server, two viewers: ${(100 * share).toFixed(1)} % of a processor`);
