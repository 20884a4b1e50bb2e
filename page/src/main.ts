// The page: hears the stream, hands each message to its panels, draws once a frame of the screen.
import 'uplot/dist/uPlot.min.css';
import './style.css';
import { rebuildCharts } from './chart';
import { Connection } from './connection';
import { byId, make, setClass, setText } from './dom';
import { quantity, sentence } from './format';
import { healthPanel } from './health_panel';
import { bindKeys } from './keys';
import { latencyPanel } from './latency_panel';
import { lobesPanel } from './lobes_panel';
import { logPanel } from './log_panel';
import { forgetLook } from './look';
import { player as makePlayer, type Player } from './player';
import { fetchAbout, type About, type Message, type State } from './protocol';
import { spectrumPanel } from './spectrum_panel';
import { faceOf, stateWords, symbol } from './states';
import { statePanel } from './state_panel';
import { trendPanel } from './trend_panel';

const staleMs = 1000; // twenty states missed
const watchMs = 200;
const peekMs = 250; // from the first state on: the rest of what the server knows of a place follows it
const sources: Record<string, string> = { daemon: 'live', recording: 'recording', simulation: 'simulation' };

function start(about: About): void {
  document.body.dataset['title'] = about.title;
  setText(byId('title'), about.title);
  setText(byId('source'), `${sources[about.source] ?? about.source}: ${about.where}`);
  const live = about.source === 'daemon';

  const top = statePanel();
  const spectrum = spectrumPanel();
  const lobes = lobesPanel(about);
  const trend = trendPanel(about);
  const log = logPanel(about);
  const health = healthPanel();
  const latency = latencyPanel();
  if (!live) setText(byId('latency-summary'), 'none: no loop runs here');
  const calm = matchMedia('(prefers-reduced-motion: reduce)');
  let state: State | null = null;
  let freshState = false;
  let stale = false;
  let peeking = false;
  let peekTimer = 0;
  let player: Player | null = null;
  const speed = (): number => player?.speed ?? 1;

  const receive = (message: Message): void => {
    switch (message.kind) {
      case 'state':
        state = message.value;
        freshState = true;
        lobes.setState(state);
        spectrum.setChatter(state.chatter_hz);
        trend.add(state, speed());
        if (peeking) peekTimer = window.setTimeout(listen, peekMs);
        peeking = false;
        break;
      case 'spectrum':
        spectrum.show(message.value);
        break;
      case 'lobes':
        lobes.show(message.value);
        break;
      case 'event':
        log.addEvent(message.value);
        trend.addEvent(message.value);
        break;
      case 'correction':
        log.addCorrection(message.value);
        trend.addCorrection(message.value);
        break;
      case 'health':
        health.show(message.value);
        break;
      case 'latency':
        latency.show(message.value);
        break;
      case 'end':
        player?.ended();
        connection.close();
        break;
    }
  };

  /** Another server, or another recording, at the same address: everything begins anew. */
  const reopened = async (): Promise<void> => {
    const now = await fetchAbout().catch(() => about);
    const same = (['title', 'source', 'where', 'version'] as const).every((key) => now[key] === about[key]);
    if (!same) location.reload();
  };
  const address = (): string =>
    player ? `api/stream?from=${player.position_s.toFixed(3)}&speed=${player.speed}` : 'api/stream';
  // A server may take its time to go to a place in a recording.
  const connection = new Connection(address, live ? 3000 : 30000, receive, () => void reopened());

  const listen = (): void => {
    window.clearTimeout(peekTimer);
    peeking = false;
    const wanted = !document.hidden && (!player || player.playing);
    if (wanted) connection.open();
    else connection.close();
  };
  /** Paused: hears until the place that was sought is shown, however long the server takes to go there. */
  const peek = (): void => {
    window.clearTimeout(peekTimer);
    peeking = true;
    connection.open();
  };
  if (!live) {
    player = makePlayer(about, (cleared) => {
      if (cleared) for (const panel of [spectrum, lobes, trend, log]) panel.reset();
      if (cleared) freshState = false; // of the place that was left
      if (cleared && player && !player.playing) peek();
      else listen();
    });
  }

  const watch = (): void => {
    const nowMs = performance.now();
    connection.watch(nowMs);
    const silentMs = nowMs - connection.heardMs;
    stale = connection.wanted && silentMs > staleMs;
    document.body.classList.toggle('stale', stale);
    const seconds = quantity(silentMs / 1000, 0, 's');
    const ago = `last heard ${seconds} ago`;
    const silent = live ? `no data, ${ago}` : `waiting for the recording, ${seconds}`;
    const heard = live ? 'connected' : player?.playing ? 'playing' : 'paused';
    const words = !stale ? heard : connection.lost ? `connection lost, ${ago}` : silent;
    setText(byId('connection'), connection.refused ? `${words}; ${connection.refused} messages not understood` : words);
    setClass(byId('connection'), `chip${stale ? ' lost' : ''}`);
    if (stale) top.showNoData(`${sentence(words)}.${state ? ` The last state was: ${state.state}.` : ''}`);
  };
  window.setInterval(() => {
    if (!document.hidden) watch();
  }, watchMs);

  const frame = (nowMs: number): void => {
    requestAnimationFrame(frame); // the browser stops calling while the page is hidden
    if (freshState && state && !stale) {
      top.show(state);
      player?.moved(state.t);
      freshState = false;
    } else if (freshState) {
      watch(); // heard again
    }
    spectrum.frame(nowMs, !calm.matches);
    lobes.frame();
    trend.frame(nowMs);
    log.frame();
    latency.frame();
  };

  const restyle = (): void => {
    forgetLook();
    rebuildCharts();
    spectrum.restyle();
  };
  bindKeys(player, bindTheme(restyle));
  window.addEventListener('resize', forgetLook);
  document.addEventListener('visibilitychange', listen);
  for (const word of stateWords) {
    byId('help-states').append(
      make('li', '', symbol(word), make('strong', '', sentence(word)), make('span', '', faceOf(word).text)),
    );
  }
  listen();
  requestAnimationFrame(frame);
}

/** The theme: the system's, unless the button chose one. Returns what changes it. */
function bindTheme(restyle: () => void): () => void {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const chosen = stored('theme');
  const root = document.documentElement;
  const apply = (): void => {
    const isDark = root.dataset['theme'] ? root.dataset['theme'] === 'dark' : dark.matches;
    setText(byId('theme'), isDark ? 'Light' : 'Dark');
    restyle();
  };
  if (chosen === 'dark' || chosen === 'light') root.dataset['theme'] = chosen;
  const toggle = (): void => {
    const isDark = root.dataset['theme'] ? root.dataset['theme'] === 'dark' : dark.matches;
    root.dataset['theme'] = isDark ? 'light' : 'dark';
    store('theme', root.dataset['theme']);
    apply();
  };
  dark.addEventListener('change', apply);
  byId('theme').addEventListener('click', toggle);
  apply();
  return toggle;
}

// A browser may refuse to keep anything: then the choice lasts as long as the page.
function stored(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}
function store(key: string, value: string): void {
  try {
    localStorage.setItem(key, value);
  } catch {
    return;
  }
}

/** The page may be loaded before its server answers, or from a browser's store. */
async function begin(): Promise<void> {
  let about: About | null = null;
  while (!about) {
    try {
      about = await fetchAbout();
    } catch (error) {
      setText(byId('state-reason'), `The server does not answer (${String(error)}); it is asked again every 2 s.`);
      await new Promise((resolve) => window.setTimeout(resolve, 2000));
    }
  }
  start(about);
}

void begin();
