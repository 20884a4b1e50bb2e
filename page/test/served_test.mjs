// The page and `stillcut scope` itself: a simulated cut, played. STILLCUT_PROGRAMS: the folder of the programs; PAGE_URL:
// look at the server there instead, of a recording or a simulation with at least one chatter.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { dirname, normalize } from 'node:path';
import { createInterface } from 'node:readline';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { launch, open, until, waitForText } from './browser.mjs';
import { checkPanels } from './panels.mjs';

const root = normalize(`${dirname(fileURLToPath(import.meta.url))}/../..`);
let browser, program, url;
before(async () => {
  browser = await launch();
  url = process.env.PAGE_URL;
  if (url) return;
  program = spawn(`${process.env.STILLCUT_PROGRAMS ?? `${root}/build`}/stillcut`, ['scope',
    `${root}/examples/demo-cell/cell.toml`, '--scenario', `${root}/examples/scenarios/depth-step.toml`, '--port', '0', '--json'],
  { stdio: ['ignore', 'pipe', 'inherit'] });
  for await (const line of createInterface(program.stdout)) {
    url = JSON.parse(line).url;
    break;
  }
});
after(async () => {
  await browser?.close();
  program?.kill();
});

test('EveryPanelShowsWhatScopeSends', async () => {
  const page = await checkPanels(browser, url, ['state', 'spectrum', 'lobes', 'health', 'event', 'correction'], '?from=0&speed=2');
  await page.context().close();
});

test('ChatterIsShownWhereTheRecordingIsMarked', async () => {
  const about = await (await fetch(`${url}api/about`)).json();
  const onset = about.marks.find((m) => m.event === 'chatter_onset');
  const page = await open(browser, url);
  await until(async () => (await page.locator('.mark').count()) === about.marks.length, 'every mark is there');
  await page.locator('#speed').selectOption('0.25'); // to see what may last a moment
  await page.locator('.mark.chatter_onset').first().click();
  await waitForText(page, 'log', /Chatter begins/);
  await waitForText(page, 'state-word', /Chatter|Correcting/);
  await until(async () => Number(await page.inputValue('#position')) >= onset.t - 0.1, 'it plays from there');
  await page.locator('#speed').selectOption('50');
  await waitForText(page, 'play', 'Play'); // it ends
  assert.ok(Math.abs(Number(await page.inputValue('#position')) - about.duration_s) < 0.11);
  assert.deepEqual(page.problems, []);
  await page.context().close();
});
