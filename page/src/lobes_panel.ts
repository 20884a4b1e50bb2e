// Stability lobes of the present posture, with the operating point in them and the advised one.
import type uPlot from 'uplot';
import { bottomAxis, Chart, plain, rightEms, sideAxis } from './chart';
import { byId, setText } from './dom';
import { depth, hertz, niceCeil, percent, quantity } from './format';
import { look, rimmedText } from './look';
import type { About, Lobes, State } from './protocol';

const modesTold = 8;

export interface LobesPanel {
  show(lobes: Lobes): void;
  setState(state: State): void;
  frame(): void;
  reset(): void;
}

export function lobesPanel(about: About): LobesPanel {
  let lobes: Lobes | null = null;
  let state: State | null = null;
  let top_mm = 1;
  let fresh = false;
  let moved = false;
  let pointKey = '';

  const speedRange = (): [number, number] => {
    const speeds = (lobes?.rpm ?? []).filter((v): v is number => v !== null);
    const low = Math.min(about.min_rpm ?? Infinity, speeds[0] ?? Infinity);
    const high = Math.max(about.max_rpm ?? -Infinity, speeds.at(-1) ?? -Infinity);
    return low < high ? [low, high] : [0, 10000];
  };

  const words = (u: uPlot): void => {
    if (!lobes) return;
    const { ctx, bbox } = u;
    const inset = 0.9 * look().rem * devicePixelRatio;
    rimmedText(ctx, 'chatter', bbox.left + inset, bbox.top + inset, look().muted, 'left');
    rimmedText(ctx, 'stable', bbox.left + inset, bbox.top + bbox.height - inset, look().muted, 'left');
  };

  const points = (u: uPlot): void => {
    if (!state || state.rpm === null) return;
    const { ctx, bbox } = u;
    const r = 0.5 * look().rem * devicePixelRatio;
    const clampX = (x: number): number => Math.min(Math.max(x, bbox.left), bbox.left + bbox.width);
    const x = clampX(u.valToPos(state.rpm, 'x', true));
    const y = state.depth_mm === null ? bbox.top + bbox.height : Math.max(u.valToPos(state.depth_mm, 'y', true), bbox.top);
    ctx.save();
    ctx.lineWidth = 2 * devicePixelRatio;
    ctx.strokeStyle = look().text;
    if (state.depth_mm === null) { // the speed alone is known
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, y);
      ctx.stroke();
    }
    if (state.advised_rpm !== null && state.advice === 'spindle speed') {
      const to = clampX(u.valToPos(state.advised_rpm, 'x', true));
      if (Math.abs(to - x) > 3 * r) {
        ctx.setLineDash([4 * devicePixelRatio, 3 * devicePixelRatio]);
        ctx.beginPath();
        ctx.moveTo(x, y);
        ctx.lineTo(to - Math.sign(to - x) * 1.6 * r, y);
        ctx.stroke();
        ctx.setLineDash([]);
      }
      ctx.beginPath(); // a hollow diamond
      for (const [dx, dy] of [[0, -1.6], [1.6, 0], [0, 1.6], [-1.6, 0]] as const) ctx.lineTo(to + dx * r, y + dy * r);
      ctx.closePath();
      ctx.fillStyle = look().surface;
      ctx.fill();
      ctx.stroke();
      const near = Math.max(y - 3 * r, bbox.top + r);
      rimmedText(ctx, 'advised', clampLabel(to, bbox), near, look().text);
    }
    ctx.beginPath();
    ctx.arc(x, y, r, 0, 2 * Math.PI);
    ctx.fillStyle = look().text;
    ctx.fill();
    ctx.strokeStyle = look().surface;
    ctx.stroke();
    ctx.restore();
    rimmedText(ctx, 'now', clampLabel(x, bbox), Math.min(y + 2.6 * r, bbox.top + bbox.height - r), look().text);
  };

  const chart = new Chart(byId('lobes-chart'), (l) => ({
    ...plain,
    padding: [0.8 * l.rem, rightEms * l.rem, 0, 0],
    scales: { x: { time: false, range: speedRange }, y: { range: () => [0, top_mm] } },
    axes: [
      bottomAxis(l, 'spindle speed, rpm'),
      sideAxis(l, 'axial depth, mm'),
    ],
    series: [{}, { stroke: l.stable, width: 2.5, fill: `${l.stable}26`, points: { show: false } }],
    hooks: { draw: [words, points] },
  }), [[], []]);

  const reset = (): void => {
    lobes = state = null;
    fresh = true;
  };

  return {
    show(next) {
      lobes = next;
      fresh = true;
    },

    setState(next) {
      state = next;
      const key = `${next.rpm?.toFixed(0)} ${next.depth_mm?.toFixed(3)} ${next.advised_rpm?.toFixed(0)} ${next.advice}`;
      moved ||= key !== pointKey;
      pointKey = key;
    },

    frame() {
      if (fresh && lobes) {
        top_mm = topOf(lobes, state);
        const above = 2 * top_mm; // stable at every depth: the line leaves the chart
        const pairs = lobes.rpm.map((rpm, i) => [rpm, lobes?.limit_mm[i] ?? above]).filter(([rpm]) => rpm !== null);
        chart.show([pairs.map(([rpm]) => rpm as number), pairs.map(([, mm]) => Math.min(mm as number, above))]);
        setText(byId('lobes-modes'), modesOf(lobes));
      } else if (fresh) {
        chart.show([[], []]);
        setText(byId('lobes-modes'), '–');
      } else if (moved) {
        chart.redraw();
      }
      if (state && (fresh || moved)) setText(byId('lobes-caption'), caption(lobes, state));
      fresh = moved = false;
    },

    reset,
  };
}

function clampLabel(x: number, bbox: uPlot.BBox): number {
  const half = 2 * look().rem * devicePixelRatio;
  return Math.min(Math.max(x, bbox.left + half), bbox.left + bbox.width - half);
}

/** The depth at the chart's top: the pockets may reach far up, what matters lies near limits and cut. */
function topOf(lobes: Lobes, state: State | null): number {
  const limits = lobes.limit_mm.filter((v): v is number => v !== null && v > 0).sort((a, b) => a - b);
  const wanted = Math.max(3 * (limits[0] ?? 0), 1.2 * (limits[Math.floor(limits.length / 2)] ?? 0),
    1.3 * (state?.depth_mm ?? 0), 1.2 * (state?.limit_mm ?? 0));
  return wanted > 0 ? niceCeil(wanted) : 1;
}

/** In words what the picture shows, for ears too. */
function caption(lobes: Lobes | null, state: State): string {
  if (!lobes) return 'no lobes known for this posture';
  if (state.rpm === null) return 'spindle speed not known';
  const i = nearest(lobes.rpm, state.rpm);
  const limit = i === null ? undefined : lobes.limit_mm[i];
  const at = `at ${quantity(state.rpm, 0, 'rpm')}`;
  if (i === null || limit === undefined) return at;
  if (limit === null) return `${at} stable at every depth looked at`;
  if (limit === 0) return `${at} unstable at every depth`;
  const hz = lobes.chatter_hz[i] ?? null;
  return `${at} stable up to ${depth(limit)}\u00a0mm${hz === null ? '' : `, beyond it chatter at ${hertz(hz)}`}`;
}

function modesOf(lobes: Lobes): string {
  const modes = lobes.modes.slice(0, modesTold).map((m) => `${hertz(m.hz)} (${percent(m.damping_ratio, 1)})`);
  if (lobes.modes.length > modesTold) modes.push(`${lobes.modes.length - modesTold} more`);
  return modes.join(', ') || '–';
}

/** The speed of the diagram next to `rpm`, or null outside of it. */
function nearest(speeds: (number | null)[], rpm: number | null): number | null {
  if (rpm === null || speeds.length < 2) return null;
  let best = 0;
  speeds.forEach((s, i) => {
    if (s !== null && Math.abs(s - rpm) < Math.abs((speeds[best] ?? Infinity) - rpm)) best = i;
  });
  const step = Math.abs((speeds[1] ?? 0) - (speeds[0] ?? 0));
  return Math.abs((speeds[best] ?? Infinity) - rpm) <= step ? best : null;
}
