// Recordings: played, paused, sought in, by pointer and by keyboard.
import assert from 'node:assert/strict';
import { after, before, beforeEach, afterEach, test } from 'node:test';
import { built, launch, open, until, waitForText } from './browser.mjs';
import { startServer } from './mock_server.mjs';
import { corrections, duration_s, events } from './simulated_cut.mjs';

let browser, server, page;
before(async () => { browser = await launch(); });
after(() => browser?.close());
beforeEach(async () => {
  server = await startServer({ page: built, recording: true });
  page = await open(browser, server.url);
  await waitForText(page, 'connection', 'playing');
});
afterEach(async () => {
  const { problems } = page;
  await page.context().close();
  await server.stop();
  assert.deepEqual(problems, []);
});

const streams = () => server.requests.filter((r) => r.startsWith('/api/stream')).map((r) => new URL(r, server.url).searchParams);
const last = () => streams().at(-1);
const position = async () => Number(await page.inputValue('#position'));

test('ShowsMarksWhereTheyAre', async () => {
  const shown = await page.locator('.mark').evaluateAll((marks) => marks.map((m) => [m.className.split(' ')[1], parseFloat(m.style.left)]));
  const expected = [...events.map((e) => [e.event, e.t]), ...corrections.map((c) => ['correction', c.t])]
    .sort((a, b) => a[1] - b[1]).map(([name, t]) => [name, (100 * t) / duration_s]);
  assert.equal(shown.length, expected.length);
  shown.forEach(([name, left], i) => {
    assert.equal(name, expected[i][0]);
    assert.ok(Math.abs(left - expected[i][1]) < 0.01, `${name} at ${left} %`);
  });
});

test('PlaysOnAndPausesWithSpace', async () => {
  await until(async () => (await position()) > 0.3, 'it plays');
  await page.keyboard.press(' ');
  await until(() => server.clients === 0, 'the stream is closed');
  await waitForText(page, 'connection', 'paused');
  const at = await position();
  assert.equal(await page.textContent('#play'), 'Play');
  assert.equal(await page.evaluate(() => document.body.classList.contains('stale')), false);
  await page.keyboard.press(' ');
  await until(() => streams().length === 2, 'it is opened again');
  assert.ok(Math.abs(Number(last().get('from')) - at) < 0.2, `from ${last().get('from')}, paused at ${at}`);
});

test('SeeksWithArrowsAndMarks', async () => {
  await page.keyboard.press(' ');
  await page.keyboard.press('Home');
  await page.keyboard.press('Shift+ArrowRight');
  for (let i = 0; i < 3; i++) await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowLeft');
  await until(() => last().get('from') === '12.000', 'the stream from 12 s is asked for');
  assert.equal(await position(), 12); // paused: it stays, and shows the place
  await waitForText(page, 'state-word', 'Chatter');
  await until(() => server.clients === 0, 'it is paused still');
  await page.keyboard.press('n');
  assert.ok(Math.abs((await position()) - corrections[0].t) < 0.06);
  await page.keyboard.press('p');
  await page.keyboard.press('p');
  assert.equal(await position(), 4);
});

test('SeeksByPointer', async () => {
  const box = await page.locator('#position').boundingBox();
  await page.mouse.click(box.x + 0.75 * box.width, box.y + box.height / 2);
  await until(() => Math.abs(Number(last().get('from')) - 0.75 * duration_s) < 0.5, 'the stream from three quarters is asked for');
  await page.locator('.mark.chatter_onset').first().click();
  await until(() => last().get('from') === '12.000', 'the stream from the mark is asked for');
  await waitForText(page, 'state-word', /Chatter|Correcting/);
});

test('PlaysFasterAndEndsAndPlaysAgain', async () => {
  for (const speed of ['2', '5', '10', '50']) {
    await page.keyboard.press('+');
    await until(() => last().get('speed') === speed, `speed ${speed} is asked for`);
  }
  await until(async () => (await position()) === duration_s, 'it comes to the end');
  await waitForText(page, 'play', 'Play');
  await until(() => server.clients === 0, 'the stream is closed');
  const asked = streams().length;
  await page.waitForTimeout(700); // longer than the first pause before a stream is opened anew
  assert.equal(streams().length, asked, 'an ended recording is not begun anew by itself');
  await page.keyboard.press(' ');
  await until(() => streams().length === asked + 1, 'it plays again');
  assert.equal(last().get('from'), '0.000');
});

test('GoesOnWhereItWasAfterTheServerDied', async () => {
  await page.keyboard.press('Shift+ArrowRight');
  await waitForText(page, 'time', /^1[01]\./);
  const { port } = server;
  await server.stop();
  await waitForText(page, 'connection', /^connection lost/);
  server = await startServer({ page: built, recording: true, port });
  await waitForText(page, 'connection', 'playing');
  assert.ok(Number(last().get('from')) >= 10, `from ${last().get('from')}`);
  page.problems = page.problems.filter((p) => !p.includes('net::ERR_'));
});
