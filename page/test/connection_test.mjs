// The page when its server falls silent, dies, comes back, or comes back as another one; and when nobody looks.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch, open, serve, until, waitForText } from './browser.mjs';

let browser;
before(async () => { browser = await launch(); });
after(() => browser?.close());

const isStale = (page) => page.evaluate(() => document.body.classList.contains('stale'));

test('SaysThatDataAreOldWhileTheServerIsSilent', async (t) => {
  const server = await serve(t, { at: 5 });
  const page = await open(browser, server.url);
  await waitForText(page, 'state-word', 'Stable');
  server.setSilent(true);
  await waitForText(page, 'state-word', 'No data');
  assert.ok(await isStale(page));
  await waitForText(page, 'state-reason', /^No data, last heard \d+\u00a0s ago\. The last state was: stable\.$/);
  assert.match(await page.textContent('#announced'), /^State: no data/);
  // Silent for long, the stream is closed and another opened: a half-open connection tells nothing.
  const streams = () => server.requests.filter((r) => r.startsWith('/api/stream')).length;
  await until(() => streams() === 2 && server.clients === 1, 'the stream is opened anew');
  server.setSilent(false);
  await waitForText(page, 'state-word', /Stable|Watch/);
  await until(async () => !(await isStale(page)), 'the mark of old data goes');
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('TakesNothingElseForAState', async (t) => {
  const server = await serve(t, { at: 5 });
  const page = await open(browser, server.url);
  await waitForText(page, 'state-word', 'Stable');
  server.setStateless(true);
  await waitForText(page, 'state-word', 'No data');
  server.setStateless(false);
  await waitForText(page, 'state-word', 'Stable');
  await page.context().close();
});

test('ComesBackByItselfAfterTheServerDied', async (t) => {
  let server = await serve(t, { at: 5 });
  const { port } = server;
  const page = await open(browser, server.url);
  await waitForText(page, 'state-word', 'Stable');
  await server.stop();
  await waitForText(page, 'state-reason', /^Connection lost, last heard \d+\u00a0s ago/);
  assert.match(await page.textContent('#connection'), /^connection lost/);
  server = await serve(t, { port, at: 5 });
  server.hold({ rpm: 4444 });
  await waitForText(page, 'rpm', '4444');
  await waitForText(page, 'connection', 'connected');
  assert.equal(await isStale(page), false);
  assert.equal(server.clients, 1);
  assert.deepEqual(page.problems.filter((p) => !p.includes('net::ERR_')), []); // the browser tells of each failed request
  await page.context().close();
});

test('BeginsAnewWhereAnotherServerAnswers', async (t) => {
  let server = await serve(t);
  const { port } = server;
  const page = await open(browser, server.url);
  await waitForText(page, 'source', /^live/);
  await server.stop();
  server = await serve(t, { port, recording: true });
  await waitForText(page, 'source', 'recording: cut.log');
  assert.ok(await page.locator('#player').isVisible());
  await page.context().close();
});

test('DoesNothingWhileNobodyLooks', async (t) => {
  const server = await serve(t);
  const page = await open(browser, server.url);
  await waitForText(page, 'connection', 'connected');
  const setHidden = (hidden) => page.evaluate((hidden) => {
    Object.defineProperty(document, 'hidden', { configurable: true, get: () => hidden });
    document.dispatchEvent(new Event('visibilitychange'));
  }, hidden);
  await setHidden(true);
  await until(() => server.clients === 0, 'a hidden page hears nothing');
  server.hold({ rpm: 2222 });
  await setHidden(false);
  await waitForText(page, 'rpm', '2222');
  assert.equal(await isStale(page), false);
  await page.context().close();
});
