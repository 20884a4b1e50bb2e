// Over time: spindle speed with its limits and what was advised, and the indicator; corrections and onsets marked.
import type uPlot from 'uplot';
import { bottomAxis, Chart, plain, rightEms, sideAxis } from './chart';
import { byId } from './dom';
import { clock } from './format';
import { look, rimmedText } from './look';
import type { About, Correction, MachineEvent, State } from './protocol';

const window_s = 60;
const pointsKept = 1200; // a minute at 20 Hz: memory stays bounded however long the page is open
const marksKept = 100;
const redrawMs = 200;

export interface TrendPanel {
  add(state: State, speed: number): void;
  addCorrection(correction: Correction): void;
  addEvent(event: MachineEvent): void;
  frame(nowMs: number): void;
  reset(): void;
}

type Point = { t: number; rpm: number | null; advised: number | null; indicator: number | null };
type Mark = { t: number; rpm: number | null; correction: boolean; limited: string };

export function trendPanel(about: About): TrendPanel {
  const live = about.source === 'daemon';
  let points: Point[] = [];
  let marks: Mark[] = [];
  let drawnMs = 0;
  let fresh = false;

  const timeRange = (): [number, number] => {
    const end = points.at(-1)?.t ?? window_s;
    const from = live ? end - window_s : Math.max(0, end - window_s);
    return [from, live ? end : from + Math.min(window_s, about.duration_s ?? window_s)];
  };
  const speedRange = (): [number, number] => {
    const known = points.flatMap((p) => (p.rpm ? [p.rpm] : []));
    const low = Math.min(about.min_rpm ?? Infinity, ...known);
    const high = Math.max(about.max_rpm ?? -Infinity, ...known);
    const margin = 0.12 * Math.max(high - low, 100);
    return low <= high ? [low - margin, high + margin] : [0, 10000];
  };
  const indicatorRange = (): [number, number] => [0, Math.min(Math.max(1.5, ...points.map((p) => 1.1 * (p.indicator ?? 0))), 10)];

  const level = (u: uPlot, value: number | null, words: string, colour: string, below: boolean): void => {
    if (value === null) return;
    const { ctx, bbox } = u;
    const y = u.valToPos(value, 'y', true);
    ctx.save();
    ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.strokeStyle = colour;
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.restore();
    const offset = (below ? 0.75 : -0.75) * look().rem * devicePixelRatio;
    rimmedText(ctx, words, bbox.left + 0.5 * look().rem * devicePixelRatio, y + offset, colour, 'left');
  };

  /** Corrections are diamonds, filled where a limit was reached; onsets of chatter triangles at the bottom. */
  const drawMarks = (u: uPlot, corrections: boolean): void => {
    const { ctx, bbox } = u;
    const r = 0.45 * look().rem * devicePixelRatio;
    const [from] = timeRange();
    ctx.save();
    ctx.lineWidth = 2 * devicePixelRatio;
    for (const mark of marks) {
      if (mark.t < from || mark.correction !== corrections) continue;
      const x = u.valToPos(mark.t, 'x', true);
      ctx.beginPath();
      if (mark.correction) {
        if (mark.rpm === null) continue;
        const y = u.valToPos(mark.rpm, 'y', true);
        ctx.strokeStyle = look().text;
        ctx.fillStyle = mark.limited ? look().text : look().surface;
        for (const [dx, dy] of [[0, -1.3], [1.3, 0], [0, 1.3], [-1.3, 0]] as const) ctx.lineTo(x + dx * r, y + dy * r);
      } else {
        const y = bbox.top + bbox.height;
        ctx.strokeStyle = ctx.fillStyle = look().alarm;
        for (const [dx, dy] of [[-1, 0], [1, 0], [0, -1.8]] as const) ctx.lineTo(x + dx * r, y + dy * r);
      }
      ctx.closePath();
      ctx.fill();
      ctx.stroke();
    }
    ctx.restore();
  };

  // No label so far to the right that it would be cut off.
  const times = (_: uPlot, values: number[]): string[] => {
    const [from, to] = timeRange();
    return values.map((t) => (live && t > to - 0.04 * (to - from) ? '' : clock(t, live, 0)));
  };
  const speeds = new Chart(byId('speed-chart'), (l) => ({
    ...plain,
    padding: [0.6 * l.rem, rightEms * l.rem, 0, 0],
    scales: { x: { time: false, range: timeRange }, y: { range: speedRange } },
    axes: [
      bottomAxis(l, '', { show: false }),
      sideAxis(l, 'speed, rpm'),
    ],
    series: [
      {},
      { stroke: l.second, width: 2, dash: [6, 4], points: { show: false } },
      { stroke: l.data, width: 2, points: { show: false } },
    ],
    hooks: {
      drawClear: [(u) => level(u, about.min_rpm, 'lowest', look().muted, false),
        (u) => level(u, about.max_rpm, 'highest', look().muted, true)],
      draw: [(u) => drawMarks(u, true)],
    },
  }), [[], [], []]);
  const indicator = new Chart(byId('indicator-chart'), (l) => ({
    ...plain,
    padding: [0.6 * l.rem, rightEms * l.rem, 0, 0],
    scales: { x: { time: false, range: timeRange }, y: { range: indicatorRange } },
    axes: [
      bottomAxis(l, live ? 'time of day' : 'time since the first frame', { values: times, space: 6 * l.rem }),
      sideAxis(l, 'indicator'),
    ],
    series: [{}, { stroke: l.data, width: 2, points: { show: false } }],
    hooks: { draw: [(u) => level(u, 1, 'alarm limit', look().alarm, false), (u) => drawMarks(u, false)] },
  }), [[], []]);

  const addMark = (mark: Mark): void => {
    if (marks.some((m) => m.t === mark.t && m.correction === mark.correction)) return; // sent again on connecting
    marks.push(mark);
    if (marks.length > marksKept) marks = marks.slice(-marksKept);
    fresh = true;
  };

  return {
    add(state, speed) {
      const last = points.at(-1);
      if (last && state.t <= last.t) return;
      const gap = last && state.t - last.t > 0.5 * Math.max(speed, 1); // not heard: no line through it
      if (gap) points.push({ t: last.t + 1e-3, rpm: null, advised: null, indicator: null });
      const advised = state.advice === 'spindle speed' ? state.advised_rpm : null;
      points.push({ t: state.t, rpm: state.rpm, advised, indicator: state.indicator });
      const from = state.t - window_s;
      if (points.length > pointsKept + 200) points = points.filter((p) => p.t >= from).slice(-pointsKept);
      fresh = true;
    },

    addCorrection(c) {
      addMark({ t: c.t, rpm: c.rpm_target, correction: true, limited: c.limited_by.join(', ') });
    },

    addEvent(event) {
      if (event.event === 'chatter_onset') addMark({ t: event.t, rpm: null, correction: false, limited: '' });
    },

    frame(nowMs) {
      if (!fresh || nowMs - drawnMs < redrawMs) return;
      fresh = false;
      drawnMs = nowMs;
      const t = points.map((p) => p.t);
      speeds.show([t, points.map((p) => p.advised), points.map((p) => p.rpm)]);
      indicator.show([t, points.map((p) => p.indicator)]);
    },

    reset() {
      points = [];
      marks = [];
      fresh = true;
    },
  };
}
