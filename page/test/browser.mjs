// What the tests of the page share: a browser, a page that keeps account of what goes wrong, a reader of the stream.
import assert from 'node:assert/strict';
import { fileURLToPath } from 'node:url';
import { dirname, normalize } from 'node:path';
import { chromium } from 'playwright-core';
import { startServer } from './mock_server.mjs';

/** The built page: STILLCUT_PAGE, or where CMake puts it. */
export const built = process.env.STILLCUT_PAGE ?? normalize(`${dirname(fileURLToPath(import.meta.url))}/../../build/page`);
const patienceMs = 15000; // of a busy machine; nothing is asserted about time

export const launch = () => chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox'] });

/** Opens `url`; `page.problems` lists errors of scripts and console and requests that leave the server. */
export async function open(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1366, height: 900 }, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(patienceMs);
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (m) => { if (m.type() === 'error' || m.type() === 'warning') page.problems.push(m.text()); });
  page.on('request', (request) => {
    if (!request.url().startsWith(url) || request.method() !== 'GET') page.problems.push(`${request.method()} ${request.url()}`);
  });
  await page.goto(url);
  return page;
}

/** A mock server that ends with the test, however that ends. */
export async function serve(t, options) {
  const server = await startServer({ page: built, ...options });
  t.after(() => server.stop());
  return server;
}

/** Waits until an element's text is, or matches, what is given. */
export async function waitForText(page, id, expected) {
  const [source, flags] = expected instanceof RegExp ? [expected.source, expected.flags] : [null, ''];
  await page.waitForFunction(
    ({ id, source, flags, expected }) => {
      const text = document.getElementById(id).textContent;
      return source === null ? text === expected : new RegExp(source, flags).test(text);
    },
    { id, source, flags, expected: source === null ? expected : null },
  ).catch(async (error) => {
    throw new Error(`#${id} is '${await page.textContent(`#${id}`)}', not ${expected}: ${error.message.split('\n')[0]}`);
  });
}

/** Polls until `ask` gives something true. */
export async function until(ask, what) {
  for (const end = Date.now() + patienceMs; Date.now() < end; await new Promise((r) => setTimeout(r, 30))) {
    if (await ask()) return;
  }
  assert.fail(`never: ${what}`);
}

/** Reads a stream by itself, an oracle apart from the page: messages by kind, the newest hundred of each. */
export function listen(url, query = '') {
  const heard = {};
  const stop = new AbortController();
  const read = async () => {
    const answer = await fetch(`${url}api/stream${query}`, { signal: stop.signal });
    let rest = '';
    for await (const chunk of answer.body.pipeThrough(new TextDecoderStream())) {
      const blocks = (rest + chunk).split('\n\n');
      rest = blocks.pop();
      for (const block of blocks) {
        const [, kind, data] = /^event: (.*)\ndata: (.*)$/s.exec(block) ?? [];
        if (kind) (heard[kind] = [...(heard[kind] ?? []), JSON.parse(data)].slice(-100));
      }
    }
  };
  read().catch((error) => { if (error.name !== 'AbortError') throw error; });
  return { heard, stop: () => stop.abort() };
}

/** How many different colours an element's canvas holds: a chart that was not drawn has one. */
export function colours(page, selector) {
  return page.evaluate((selector) => {
    const canvas = document.querySelector(selector);
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return new Set(new Uint32Array(data.buffer)).size;
  }, selector);
}
