// Serves the built page and a made-up stream as `stillcut scope` would, for development, tests and the benchmark. Tests
// can hold it to a state, make it fall silent, stop it and start it again at the same port.
//   node test/mock_server.mjs [--port N] [--page FOLDER] [--recording] [--at SECONDS]
import { createReadStream } from 'node:fs';
import { stat } from 'node:fs/promises';
import { createServer } from 'node:http';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import * as cut from './simulated_cut.mjs';

const policy = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
const types = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };
const tickMs = 50;

/** Options: `port` (0: any), `page` (the built page), `recording`, `at` (where in the cut a live stream begins, s). */
export async function startServer({ port = 0, page, recording = false, at = 0 } = {}) {
  const clients = new Set();
  const started = Date.now() / 1000;
  let ticks = 0;
  const present = () => started + (ticks * tickMs) / 1000; // in whole ticks, however late a busy machine makes them
  let held = null; // state fields given by a test
  let silent = false;
  let stateless = false;
  let requests = [];

  /** Where in the cut this client is, and the time stamp that goes with it. */
  const timeOf = (client) => {
    const now = present();
    if (recording) return { inCut: client.from + client.speed * (now - client.since), t: client.from + client.speed * (now - client.since) };
    return { inCut: (now - started + at) % cut.duration_s, t: now };
  };
  const send = (client, event, data) => client.response.write(`event: ${event}\ndata: ${JSON.stringify(data)}\n\n`);
  const sendState = (client) => {
    const { inCut, t } = timeOf(client);
    send(client, 'state', { ...cut.stateAt(inCut, { live: !recording }), ...held, t });
  };

  const sendCorrection = (client, c, t) => send(client, 'correction', { ...c, mode: recording ? 'shadow' : 'active', t });

  const tick = (client) => {
    const { inCut, t } = timeOf(client);
    if (silent) return;
    if (recording && inCut >= cut.duration_s) {
      send(client, 'end', { t: cut.duration_s });
      client.response.end();
      clients.delete(client);
      return;
    }
    if (!stateless) sendState(client);
    send(client, 'spectrum', { ...cut.spectrumAt(inCut), t });
    const due = (from) => client.last !== null && from > client.last && from <= inCut;
    for (const e of cut.events) if (due(e.t)) send(client, 'event', { ...e, t: t - (inCut - e.t) });
    for (const c of cut.corrections) if (due(c.t)) sendCorrection(client, c, t - (inCut - c.t));
    if (client.ticks++ % 20 === 0) {
      send(client, 'lobes', { ...cut.lobesAt(inCut), t });
      send(client, 'health', { ...cut.healthAt(inCut), t });
      send(client, 'latency', { ...cut.latencyAt(inCut, Date.now() / 1000 - started), t });
    }
    client.last = inCut;
  };

  const about = () => ({
    title: 'demo-cell', source: recording ? 'recording' : 'daemon', where: recording ? 'cut.log' : 'udpm://239.255.76.67:7667?ttl=0',
    duration_s: recording ? cut.duration_s : null, start_utime: Math.round(1e6 * started), teeth: 2, min_rpm: 3000, max_rpm: 3600, version: '0.1.0',
    marks: recording ? [...cut.events, ...cut.corrections.map((c) => ({ t: c.t, event: 'correction', kind: c.kind }))]
      .map(({ t, event, kind }) => ({ t, event, kind })).sort((a, b) => a.t - b.t) : [],
  });

  const answer = async (request, response) => {
    requests.push(request.url);
    requests = requests.slice(-1000);
    response.setHeader('Content-Security-Policy', policy);
    response.setHeader('X-Content-Type-Options', 'nosniff');
    const url = new URL(request.url, 'http://localhost');
    if (request.method !== 'GET') {
      response.writeHead(405, { Allow: 'GET' }).end();
    } else if (url.pathname === '/api/about') {
      response.writeHead(200, { 'Content-Type': 'application/json' }).end(JSON.stringify(about()));
    } else if (url.pathname === '/api/stream') {
      response.writeHead(200, { 'Content-Type': 'text/event-stream', 'Cache-Control': 'no-store' });
      response.flushHeaders();
      const number = (name, otherwise) => (recording ? Number(url.searchParams.get(name) ?? otherwise) : otherwise);
      const client = { response, from: number('from', 0), speed: number('speed', 1), since: present(), last: null, ticks: 0 };
      const { inCut, t } = timeOf(client);
      if (!silent) { // the last events and corrections, so that the page is filled at once
        for (const e of cut.events) if (e.t <= inCut) send(client, 'event', { ...e, t: t - (inCut - e.t) });
        for (const c of cut.corrections) if (c.t <= inCut) sendCorrection(client, c, t - (inCut - c.t));
      }
      clients.add(client);
      request.on('close', () => clients.delete(client));
      tick(client);
    } else {
      const name = normalize(url.pathname === '/' ? '/index.html' : url.pathname);
      const file = join(page, name);
      if (!file.startsWith(page) || !(await stat(file).catch(() => null))?.isFile()) {
        response.writeHead(404).end();
        return;
      }
      response.writeHead(200, { 'Content-Type': types[extname(file)] ?? 'application/octet-stream' });
      createReadStream(file).pipe(response);
    }
  };

  const server = createServer((request, response) => void answer(request, response));
  await new Promise((resolve, reject) => server.once('error', reject).listen(port, '127.0.0.1', resolve));
  const timer = setInterval(() => {
    while (started + ((ticks + 1) * tickMs) / 1000 <= Date.now() / 1000) {
      ticks += 1;
      clients.forEach(tick);
    }
  }, tickMs / 2);
  const bound = server.address().port;
  return {
    url: `http://127.0.0.1:${bound}/`,
    port: bound,
    get clients() { return clients.size; },
    get requests() { return requests; },
    /** Lays fields over the state and sends it at once; null: the cut's own again. */
    hold(fields) {
      held = fields;
      if (!silent) clients.forEach(sendState);
    },
    /** Sends something to every client. */
    send: (event, data) => clients.forEach((client) => send(client, event, data)),
    setSilent: (value) => { silent = value; },
    /** Everything goes on but the states. */
    setStateless: (value) => { stateless = value; },
    stop() {
      clearInterval(timer);
      server.closeAllConnections();
      return new Promise((resolve) => server.close(() => resolve())); // a second call finds it closed
    },
  };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const { values } = parseArgs({ options: {
    port: { type: 'string', default: '8099' }, page: { type: 'string' }, recording: { type: 'boolean' }, at: { type: 'string', default: '0' },
  } });
  const page = values.page ?? join(dirname(fileURLToPath(import.meta.url)), '../../build/page');
  const server = await startServer({ port: Number(values.port), page: normalize(page), recording: values.recording ?? false, at: Number(values.at) });
  console.log(`${server.url}, Ctrl-C ends`);
}
