// Looks whether the page of any server shows what that server's stream says, heard apart from the page.
import assert from 'node:assert/strict';
import { colours, listen, open, until } from './browser.mjs';

const dash = '–';
/** A number as the page writes it, by another way than the page's. */
function digits(v, n) {
  if (v === null) return dash;
  const [whole, part] = Math.abs(v).toFixed(n).split('.');
  const grouped = whole.length > 4 ? Number(whole).toLocaleString('en').replaceAll(',', '\u202f') : whole;
  return (v < 0 ? '−' : '') + grouped + (part ? `.${part}` : '');
}
const hertz = (v) => digits(v, v !== null && v < 100 ? 1 : 0);
const depth = (v) => digits(v, v !== null && v < 1 ? 3 : 2);

/** `query`: of the oracle's stream; `kinds`: the messages that have to come. */
export async function checkPanels(browser, url, kinds, query = '') {
  const { heard, stop } = listen(url, query);
  const page = await open(browser, url);
  await until(() => kinds.every((kind) => heard[kind]), `${kinds} are heard`);
  const shows = async (id, kind, texts) => {
    if (!heard[kind]) return;
    await until(async () => {
      const text = await page.textContent(`#${id}`);
      return heard[kind].some((m) => texts(m).every((words) => text.includes(words)));
    }, `#${id} shows a ${kind} of the stream; it is '${await page.textContent(`#${id}`)}'`);
  };
  await shows('state-word', 'state', (s) => [s.state.slice(1)]);
  await shows('state-reason', 'state', (s) => [s.reason.slice(1)]);
  await shows('rpm', 'state', (s) => [digits(s.rpm, 0)]);
  await shows('indicator', 'state', (s) => [digits(s.indicator, 2)]);
  await shows('chatter-kind', 'state', (s) => [s.chatter_hz === null ? 'none heard' : s.chatter_kind ?? 'kind unknown']);
  await shows('depth', 'state', (s) => [depth(s.depth_mm)]);
  await shows('limit', 'state', (s) => [s.limit_mm === null ? 'limit not known' : depth(s.limit_mm)]);
  await shows('tooth-hz', 'spectrum', (s) => [hertz(s.tooth_hz)]);
  await shows('spindle-hz', 'spectrum', (s) => [hertz(s.spindle_hz)]);
  await shows('lobes-modes', 'lobes', (l) => l.modes.slice(0, 8).map((m) => hertz(m.hz)));
  await shows('sensors', 'health', (h) => h.sensors.flatMap((s) => [s.name, String(s.frames_lost)]));
  await shows('hops', 'health', (h) => h.hops.flatMap((hop) => [hop.hop, String(hop.lost)]));
  await shows('stages', 'latency', (l) => l.stages.map((s) => s.stage));
  await shows('log', 'correction', (c) => [c.kind === 'spindle speed' ? digits(c.rpm_target, 0) : '', ...c.limited_by]);
  stop();
  for (const [kind, chart] of [['spectrum', 'spectrum'], ['lobes', 'lobes'], ['state', 'speed'], ['state', 'indicator'], ['latency', 'latency']]) {
    if (heard[kind]) await until(async () => (await colours(page, `#${chart}-chart canvas`)) > 3, `the ${chart} chart is drawn`);
  }
  if (heard.spectrum) await until(async () => (await colours(page, '#waterfall')) > 50, 'the waterfall is drawn');
  const inline = await page.evaluate(() => document.querySelectorAll('style, script:not([src])').length);
  assert.equal(inline, 0, 'styles or scripts within the page');
  assert.deepEqual(page.problems, []);
  return page;
}
