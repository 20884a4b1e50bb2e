// Legible for everybody: contrast, colour vision, small and large screens, keyboard.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { built, launch, open, serve, waitForText } from './browser.mjs';
import { startServer } from './mock_server.mjs';

const states = ['stable', 'watch', 'chatter', 'correcting', 'cannot tell', 'fault', 'not cutting', 'no daemon'];
const word = (state) => state.charAt(0).toUpperCase() + state.slice(1);
let browser, server, lab;
before(async () => {
  browser = await launch();
  server = await startServer({ page: built, at: 32 }); // much to see: corrections, limits, losses
  lab = await browser.newPage(); // where pictures are measured, free of the page's policy
});
after(async () => {
  await browser?.close();
  await server?.stop();
});

/** Texts of the page whose contrast with what lies behind them is below `least` (WCAG 2.1's relative luminance). */
function faintTexts(page, least) {
  return page.evaluate((least) => {
    const parse = (colour) => (colour.match(/[\d.]+/g) ?? [0, 0, 0, 0]).map(Number);
    const luminance = ([r, g, b]) => {
      const linear = (v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
      return 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
    };
    const behind = (element) => {
      for (let e = element; e; e = e.parentElement) {
        const colour = parse(getComputedStyle(e).backgroundColor);
        if (colour.length < 4 || colour[3] === 1) return colour;
      }
      return [255, 255, 255];
    };
    const faint = [];
    let looked = 0;
    for (const element of document.querySelectorAll('body *')) {
      const own = [...element.childNodes].some((n) => n.nodeType === Node.TEXT_NODE && n.textContent.trim());
      if (!own || !element.checkVisibility()) continue;
      const [a, b] = [luminance(parse(getComputedStyle(element).color)), luminance(behind(element))];
      const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      looked += 1;
      if (contrast < least) faint.push(`${element.tagName}#${element.id}.${element.className} '${element.textContent.trim().slice(0, 30)}' ${contrast.toFixed(2)}`);
    }
    // What is written on the charts.
    const style = getComputedStyle(document.documentElement);
    const hex = (name) => [1, 3, 5].map((i) => parseInt(style.getPropertyValue(name).trim().slice(i, i + 2), 16));
    const ground = luminance(hex('--surface'));
    for (const name of ['--text', '--muted', '--second', '--alarm', '--data', '--stable']) {
      const l = luminance(hex(name));
      const contrast = (Math.max(l, ground) + 0.05) / (Math.min(l, ground) + 0.05);
      if (contrast < least) faint.push(`${name} ${contrast.toFixed(2)}`);
    }
    return { faint, looked };
  }, least);
}

/** The luminance of parts of a picture, each on a grid of 48 × 48; `boxes` in its own pixels. */
function luminances(png, boxes) {
  return lab.evaluate(async ({ base64, boxes }) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const linear = (v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
    return boxes.map((box) => {
      const ctx = new OffscreenCanvas(48, 48).getContext('2d');
      ctx.drawImage(image, box.x, box.y, box.width, box.height, 0, 0, 48, 48);
      const { data } = ctx.getImageData(0, 0, 48, 48);
      return Array.from({ length: 48 * 48 }, (_, i) => 0.2126 * linear(data[4 * i]) + 0.7152 * linear(data[4 * i + 1]) + 0.0722 * linear(data[4 * i + 2]));
    });
  }, { base64: png.toString('base64'), boxes });
}
const contrastOf = (l) => (Math.max(...l) + 0.05) / (Math.min(...l) + 0.05);

for (const colorScheme of ['light', 'dark']) {
  test(`TextsStandOutInTheme_${colorScheme}`, async () => {
    const page = await open(browser, server.url, { colorScheme });
    for (const state of states) {
      server.hold({ state, limited_by: ['speed range'], advice: 'spindle speed', chatter_hz: 700, chatter_kind: 'regenerative', mode_number: 1 });
      await waitForText(page, 'state-word', word(state));
      const { faint, looked } = await faintTexts(page, 4.5);
      assert.ok(looked > 60, `only ${looked} texts found`);
      assert.deepEqual(faint, [], `while ${state}`);
    }
    await page.keyboard.press('?');
    assert.deepEqual((await faintTexts(page, 4.5)).faint, []);
    assert.deepEqual(page.problems, []);
    server.hold(null);
    await page.context().close();
  });
}

test('StatesAreToldApartWithoutColour', async () => {
  for (const [colorScheme, types] of [['light', ['deuteranopia', 'achromatopsia']], ['dark', ['protanopia', 'achromatopsia']]]) {
    const page = await open(browser, server.url, { colorScheme, reducedMotion: 'reduce', viewport: { width: 800, height: 700 } });
    const session = await page.context().newCDPSession(page);
    for (const type of types) {
      await session.send('Emulation.setEmulatedVisionDeficiency', { type });
      const shapes = [];
      for (const state of states) {
        server.hold({ state, reason: '' });
        await waitForText(page, 'state-word', word(state));
        const boxes = await page.evaluate(() => ['state-word', 'state-symbol'].map((id) => {
          const { x, y, width, height } = document.getElementById(id).getBoundingClientRect();
          return { x, y, width, height };
        }));
        const [w, l] = await luminances(await page.screenshot({ clip: { x: 0, y: 0, width: 800, height: 350 } }), boxes);
        const text = contrastOf(w);
        assert.ok(text >= 4.5, `${state}, ${type}, ${colorScheme}: word ${text}`);
        assert.ok(contrastOf(l) >= 3, `${state}, ${type}, ${colorScheme}: symbol ${contrastOf(l)}`);
        // Its shape alone: edges, wherever neighbours differ in luminance; fill and ground may have any colour.
        const edges = l.map((v, i) => i % 48 < 47 && i < 47 * 48 && Math.max(Math.abs(v - l[i + 1]), Math.abs(v - l[i + 48])) > 0.1);
        shapes.push([state, edges]);
      }
      for (const [a, one] of shapes) {
        for (const [b, other] of shapes) {
          if (a >= b) continue;
          const union = one.filter((v, i) => v || other[i]).length;
          const differ = one.filter((v, i) => v !== other[i]).length / union;
          assert.ok(differ > 0.3, `${a} and ${b} differ in ${(100 * differ).toFixed(0)} % of their edges, ${type}, ${colorScheme}`);
        }
      }
    }
    await page.context().close();
  }
  server.hold(null);
});

test('TheWaterfallsColoursRiseInLightness', async () => {
  const page = await open(browser, server.url);
  const stops = await page.evaluate(() => getComputedStyle(document.querySelector('.colours i')).backgroundImage.match(/\d+, \d+, \d+/g).map((c) => c.split(',').map(Number)));
  const luminance = stops.map((c) => c.map((v) => (v / 255) ** 2.2)).map(([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b);
  assert.equal(stops.length, 10);
  luminance.forEach((v, i) => assert.ok(i === 0 || v > luminance[i - 1], `stop ${i}`));
  await page.context().close();
});

test('NothingIsCutOffFromPhoneToWall', async () => {
  const page = await open(browser, server.url);
  server.hold({ state: 'cannot tell', limited_by: ['speed range', 'acceleration', 'no stable setting known'], advice: 'spindle speed variation', variation_ratio: 0.1, variation_hz: 2.5, rpm: 12345, depth_mm: 12.345 });
  await waitForText(page, 'state-word', 'Cannot tell');
  await waitForText(page, 'stages', /decision/);
  for (const [width, height] of [[320, 600], [360, 740], [800, 600], [1000, 700], [1280, 720], [1920, 1080], [3840, 2160]]) {
    await page.setViewportSize({ width, height });
    const found = await page.evaluate(async () => {
      for (let i = 0; i < 3; i++) await new Promise(requestAnimationFrame); // charts follow their hosts
      const wide = [...document.querySelectorAll('body *')].filter((e) => {
        if (!e.checkVisibility() || e.closest('.scroll, .chart, .unseen') || e.clientWidth === 0) return false;
        return e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).overflowX !== 'visible' ? true : e.getBoundingClientRect().right > innerWidth + 0.5;
      });
      const spilled = [...document.querySelectorAll('.value, #state-word, #state-reason, h2, .caption')]
        .filter((e) => e.scrollWidth > e.clientWidth + 1);
      const flat = [...document.querySelectorAll('.chart')].filter((e) => e.querySelector('.u-over').clientHeight < 30);
      wide.push(...flat);
      return { scroll: document.documentElement.scrollWidth - innerWidth, wide: [...wide, ...spilled].map((e) => `${e.tagName}#${e.id}.${e.className}`) };
    });
    assert.ok(found.scroll <= 0, `${width} px: ${found.scroll} px to scroll sideways`);
    assert.deepEqual(found.wide, [], `${width} px`);
    if (width === 1920) {
      const below = await page.evaluate(() => document.documentElement.scrollHeight - innerHeight);
      assert.ok(below <= 0, `a wall display has to be scrolled by ${below} px`);
    }
  }
  assert.deepEqual(page.problems, []);
  await page.context().close();
  server.hold(null);
});

test('EveryControlIsReachedByKeyboardAndSeen', async (t) => {
  const recording = await serve(t, { recording: true });
  const page = await open(browser, recording.url);
  await waitForText(page, 'stages', /decision/);
  const order = [];
  for (let i = 0; i < 20; i++) {
    await page.keyboard.press('Tab');
    const at = await page.evaluate(() => {
      const e = document.activeElement;
      return e === document.body ? null : { name: e.id || e.getAttribute('aria-label'), outline: parseFloat(getComputedStyle(e).outlineWidth), style: getComputedStyle(e).outlineStyle };
    });
    if (!at || order.includes(at.name)) break;
    assert.ok(at.outline >= 2 && at.style !== 'none', `${at.name} shows no focus`);
    order.push(at.name);
  }
  assert.deepEqual(order, ['theme', 'help-open', 'span', 'log', 'stage', 'Latency of each stage', 'Sensors and losses', 'play', 'position', 'speed']);
  const unnamed = await page.evaluate(() => [...document.querySelectorAll('button, select, input, [role=img]')]
    .filter((e) => !(e.getAttribute('aria-label') || e.textContent.trim())).map((e) => e.id));
  assert.deepEqual(unnamed, []);
  await page.keyboard.press('?');
  assert.ok(await page.locator('#help').isVisible());
  await page.keyboard.press('Escape');
  assert.ok(!(await page.locator('#help').isVisible()));
  await page.context().close();
});

test('TheThemeIsTheSystemsUntilOneIsChosenAndThenKept', async () => {
  const page = await open(browser, server.url, { colorScheme: 'dark' });
  const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  await waitForText(page, 'theme', 'Light');
  const dark = await ground();
  await page.emulateMedia({ colorScheme: 'light' });
  await waitForText(page, 'theme', 'Dark');
  const light = await ground();
  assert.notEqual(dark, light);
  await page.keyboard.press('t');
  await waitForText(page, 'theme', 'Light');
  assert.equal(await ground(), dark);
  await page.reload();
  await waitForText(page, 'theme', 'Light');
  assert.equal(await ground(), dark);
  assert.deepEqual(page.problems, []);
  await page.context().close();
});
