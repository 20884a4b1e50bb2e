// How long each stage takes: a histogram over a logarithmic time with p99.9 and the longest marked, and a table.
import type uPlot from 'uplot';
import { bottomAxis, Chart, plain, rightEms, sideAxis } from './chart';
import { byId, fillRows, setText } from './dom';
import { fixed, microseconds } from './format';
import { look, rimmedText } from './look';
import type { Latency } from './protocol';

type Histogram = Latency['histograms'][number];

export interface LatencyPanel {
  show(latency: Latency): void;
  frame(): void;
}

export function latencyPanel(): LatencyPanel {
  const choice = byId<HTMLSelectElement>('stage');
  let latest: Latency | null = null;
  let fresh = false;
  let edges: [number, number] = [1, 1000]; // µs
  let top = 10;

  const histogram = (): Histogram | undefined => {
    const drawable = (latest?.histograms ?? []).filter((h) => edge(h, 0) > 0 && Number.isFinite(edge(h, h.counts.length)));
    return drawable.find((h) => h.stage === choice.value) ?? drawable[0];
  };

  const bars = (u: uPlot): void => {
    const h = histogram();
    if (!h) return;
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.fillStyle = look().data;
    const foot = bbox.top + bbox.height;
    h.counts.forEach((count, i) => {
      if (!count) return;
      const from = u.valToPos(edge(h, i), 'x', true);
      const to = u.valToPos(edge(h, i + 1), 'x', true);
      const y = u.valToPos(count, 'y', true);
      ctx.fillRect(from, y, Math.max(to - from - devicePixelRatio, 1), foot - y);
    });
    ctx.restore();
    const stage = latest?.stages.find((s) => s.stage === h.stage);
    mark(u, stage?.p999_us ?? null, 'p99.9', 1, look().second);
    mark(u, stage?.max_us ?? null, 'longest', 0, look().alarm);
  };

  /** A line at a time, told in a row of its own above the chart, so that two near each other can be read. */
  const mark = (u: uPlot, us: number | null, words: string, row: number, colour: string): void => {
    if (us === null || us <= 0) return;
    const { ctx, bbox } = u;
    const rem = look().rem * devicePixelRatio;
    const x = Math.min(Math.max(u.valToPos(us, 'x', true), bbox.left), bbox.left + bbox.width);
    const y = bbox.top - (row ? 0.75 : 1.95) * rem;
    ctx.save();
    ctx.strokeStyle = colour;
    ctx.lineWidth = 2 * devicePixelRatio;
    if (row) ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
    ctx.beginPath();
    ctx.moveTo(x, y + 0.5 * rem);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
    const half = 4.2 * rem;
    const at = Math.min(Math.max(x, bbox.left + half), bbox.left + bbox.width - half);
    rimmedText(ctx, `${words} ${microseconds(us)}`, at, y, colour);
  };

  // Of the ticks of a logarithmic axis only powers of ten: more would be a fog of lines.
  const powers = (_: uPlot, splits: number[]): (number | null)[] =>
    splits.map((v) => (v >= 1 && v.toExponential().startsWith('1e') ? v : null));
  const onlyPowers = { filter: powers, grid: { filter: powers }, ticks: { filter: powers } };
  const times = (_: uPlot, values: (number | null)[]): string[] =>
    values.map((v) => (v === null ? '' : microseconds(v).replace(/\.0+/, '')));
  const counts = (_: uPlot, values: (number | null)[]): string[] =>
    values.map((v) => (v === null ? '' : v < 1e4 ? fixed(v, 0) : `10${superscript(Math.log10(v))}`));
  const chart = new Chart(byId('latency-chart'), (l) => ({
    ...plain,
    padding: [2.7 * l.rem, rightEms * l.rem, 0, 0],
    scales: {
      x: { time: false, distr: 3, range: () => edges },
      y: { distr: 3, range: () => [0.5, top] },
    },
    axes: [
      bottomAxis(l, 'time', { values: times, ...onlyPowers }),
      sideAxis(l, 'times counted', { values: counts, ...onlyPowers }),
    ],
    series: [{}, { paths: () => null, points: { show: false } }],
    hooks: { draw: [bars] },
  }), [[1, 1000], [1, 1]]);

  choice.addEventListener('change', () => {
    fresh = true;
  });

  return {
    show(latency) {
      latest = latency;
      fresh = true;
    },

    frame() {
      if (!fresh || !latest) return;
      fresh = false;
      byId('stages').closest('.panel')?.classList.remove('empty');
      const names = latest.histograms.map((h) => h.stage);
      if (names.join() !== [...choice.options].map((o) => o.value).join()) {
        const kept = choice.value;
        choice.replaceChildren(...names.map((n) => new Option(n, n, false, n === kept)));
        choice.hidden = names.length < 2;
      }
      const late = latest.times_out ?? 0;
      setText(byId('latency-summary'), latest.in_time === null ? '' : latest.in_time && !late
        ? 'every decision in time' : `${latest.in_time ? '' : '⚠ too late now, '}${fixed(late, 0)} times too late`);
      fillRows(byId('stages'), latest.stages.map((s) => [
        s.stage, microseconds(s.p50_us), microseconds(s.p99_us), microseconds(s.p999_us), microseconds(s.max_us),
        fixed(s.count, 0),
      ]));
      const h = histogram();
      if (!h) return;
      const first = h.counts.findIndex((c) => c);
      let last = h.counts.length - 1;
      while (last > 0 && !h.counts[last]) last--;
      if (first >= 0) {
        const longest = latest.stages.find((s) => s.stage === h.stage)?.max_us ?? 0;
        const low = edge(h, first);
        const high = Math.max(edge(h, last + 1), longest);
        edges = [10 ** Math.floor(Math.log10(low)), 10 ** Math.ceil(Math.log10(high))];
        top = 2 * 10 ** Math.ceil(Math.log10(Math.max(...h.counts.map((c) => c ?? 0), 1)));
      }
      chart.show([edges, [1, 1]]);
    },
  };
}

/** Where bucket `i` begins, µs; NaN where the histogram does not say. */
function edge(h: Histogram, i: number): number {
  return (h.first_us ?? NaN) * 2 ** (i / (h.per_octave || NaN));
}

function superscript(n: number): string {
  return String(n).replace(/\d/g, (d) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(d)] ?? '');
}
