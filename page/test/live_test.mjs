// Every panel shows what the stream says, follows each change, and bears what cannot be read.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { built, colours, launch, open, until, waitForText } from './browser.mjs';
import { startServer } from './mock_server.mjs';
import { checkPanels } from './panels.mjs';

let browser, server, url;
let page; // of the tests that follow each other on one
before(async () => {
  browser = await launch();
  server = await startServer({ page: built, at: 12 });
  url = server.url;
});
after(async () => {
  await browser?.close();
  await server?.stop();
});

test('FillsEveryPanelWithWhatTheStreamSays', async () => {
  await checkPanels(browser, server.url, ['state', 'spectrum', 'lobes', 'health', 'latency', 'correction']);
});

test('TheWaterfallMovesBetweenSpectra', async () => {
  const page = await open(browser, url);
  await until(async () => Number(await page.getAttribute('#waterfall', 'data-frames')) > 20, 'frames are drawn');
  // More pictures than spectra: it scrolls on the screen's clock.
  const { frames, pictures } = await page.evaluate(async () => {
    const canvas = document.getElementById('waterfall');
    const before = Number(canvas.dataset.frames);
    const seen = new Set();
    for (let i = 0; i < 60; i++) {
      await new Promise(requestAnimationFrame);
      const { data } = canvas.getContext('2d').getImageData(100, 0, 40, canvas.height);
      seen.add(data.reduce((h, v) => (Math.imul(h, 31) + v) | 0, 0));
    }
    return { frames: Number(canvas.dataset.frames) - before, pictures: seen.size };
  });
  assert.ok(frames >= 30, `${frames} of 60 frames drawn`);
  assert.ok(pictures >= 30, `${pictures} different pictures in 60 frames`);
  await page.context().close();
});

test('ScrollsInStepsWhereMotionIsToBeReduced', async () => {
  const page = await open(browser, url, { reducedMotion: 'reduce' });
  await until(async () => (await colours(page, '#waterfall')) > 50, 'the waterfall is drawn');
  // With each spectrum at most, of which the server sends 20 a second, however slow the machine; else with each frame.
  const [drawn, took_s] = await page.evaluate(async () => {
    const canvas = document.getElementById('waterfall');
    const before = Number(canvas.dataset.frames), began = performance.now();
    for (let i = 0; i < 60; i++) await new Promise(requestAnimationFrame);
    return [Number(canvas.dataset.frames) - before, (performance.now() - began) / 1000];
  });
  assert.ok(drawn < 30 * took_s, `${drawn} of 60 frames drawn in ${took_s} s`);
  await page.context().close();
});

test('FollowsEachStateAndTellsItByWordAndShape', async () => {
  page ??= await open(browser, url);
  const shapes = new Map();
  server.hold({ state: 'unheard of' }); // not what the first of the following is
  await waitForText(page, 'state-word', 'Unheard of');
  for (const state of ['stable', 'watch', 'chatter', 'correcting', 'cannot tell', 'fault', 'not cutting', 'no daemon']) {
    server.hold({ state, reason: `Reason of ${state}.` });
    await waitForText(page, 'state-word', state.charAt(0).toUpperCase() + state.slice(1));
    assert.equal(await page.textContent('#state-reason'), `Reason of ${state}.`);
    assert.equal(await page.textContent('#announced'), `State: ${state}. Reason of ${state}.`);
    const shape = await page.evaluate(() => [...document.querySelectorAll('#state-symbol path')].map((p) => p.getAttribute('d')).join());
    assert.ok(!shapes.has(shape), `${state} has the symbol of ${shapes.get(shape)}`);
    shapes.set(shape, state);
  }
  server.hold({ state: 'astonished', reason: 'A word of a later server.' }); // shown, not guessed at
  await waitForText(page, 'state-word', 'Astonished');
  server.hold(null);
});

test('ShowsWhatIsAdvisedAndWhatLimitsIt', async () => {
  page ??= await open(browser, url);
  for (const [fields, words] of [
    [{ advice: 'spindle speed', advised_rpm: 12345 }, '→ advised 12\u202f345\u00a0rpm'],
    [{ advice: 'spindle speed variation', variation_ratio: 0.1, variation_hz: 2.5 }, '→ vary ±10\u00a0%, 2.5\u00a0Hz'],
    [{ advice: 'feed direction', advised_direction_deg: -45 }, '→ advised feed direction −45\u00a0°'],
    [{ advice: 'feed override', feed_override: 0.8 }, '→ advised feed 80\u00a0%'],
    [{ advice: 'stop request' }, '→ advised: stop'],
    [{ advice: 'release' }, 'released to the nominal speed'],
    [{ advice: null }, 'no change advised'],
  ]) {
    server.hold({ limited_by: ['path', 'feed range'], ...fields });
    await waitForText(page, 'advice', words);
    assert.match(await page.textContent('#limited-by'), /path, feed range/);
  }
  server.hold(null);
});

test('RefusesWhatItCannotReadAndGoesOn', async () => {
  page ??= await open(browser, url);
  await waitForText(page, 'connection', 'connected');
  for (const kind of ['state', 'spectrum', 'lobes', 'event', 'correction', 'health', 'latency']) {
    server.send(kind, { nothing: 'of use' });
    server.send(kind, null);
    server.send(kind, { t: 'late' });
  }
  await waitForText(page, 'connection', 'connected; 21 messages not understood');
  const t = Date.now() / 1000;
  server.send('lobes', { t, rpm: [1, null, 'x'], limit_mm: 'none', chatter_hz: null, modes: [null, 7] });
  server.send('spectrum', { t, sensor: 0, bin_hz: 0, low_db: null, step_db: 1, levels: '' });
  server.send('health', { t, sensors: [{}], hops: [3], doubts: [null] });
  server.send('spectrum', { t, sensor: 0, bin_hz: -1, low_db: -80, step_db: 1, levels: 'AAAA' });
  server.send('latency', { t, stages: [{}], histograms: [{ stage: 'x', first_us: 0, per_octave: 4, counts: [1] }, { stage: 'y', first_us: 1, per_octave: 0, counts: [1] }, {}] });
  server.send('correction', { t, limited_by: null });
  server.hold({ rpm: 'fast', limited_by: 'all', state: 'stable', reason: '<b id="injected">words</b><img src=x onerror=alert(1)>' });
  await waitForText(page, 'rpm', '–');
  assert.equal(await page.textContent('#state-reason'), '<b id="injected">words</b><img src=x onerror=alert(1)>');
  assert.equal(await page.locator('#injected').count(), 0);
  server.hold({ rpm: 4321 });
  await waitForText(page, 'rpm', '4321');
  const frames = Number(await page.getAttribute('#waterfall', 'data-frames'));
  await until(async () => Number(await page.getAttribute('#waterfall', 'data-frames')) > frames + 20, 'it still draws');
  server.hold(null);
  assert.deepEqual(page.problems, []);
});

test('KeepsBoundedWhatItRemembers', async () => {
  page ??= await open(browser, url);
  await waitForText(page, 'connection', /^connected/);
  for (let i = 0; i < 500; i++) server.send('event', { t: 1e9 + i, event: 'cut_entry', kind: '', hz: null, note: `number ${i}` });
  await waitForText(page, 'log', /number 499/);
  assert.equal(await page.locator('#log > li').count(), 60);
});
