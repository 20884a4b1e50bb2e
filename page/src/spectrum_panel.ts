// Spectrum and waterfall over one axis of frequency, with harmonics of spindle and tooth passing and the chatter marked.
import type uPlot from 'uplot';
import { bottomAxis, Chart, plain, rightEms, sideAxis } from './chart';
import { byId, setText } from './dom';
import { hertz, quantity } from './format';
import { look, rimmedText } from './look';
import type { Spectrum } from './protocol';
import { waterfall } from './waterfall';

export interface SpectrumPanel {
  show(spectrum: Spectrum): void;
  setChatter(hz: number | null): void;
  frame(nowMs: number, smooth: boolean): void;
  reset(): void;
  restyle(): void;
}

export function spectrumPanel(): SpectrumPanel {
  const fall = waterfall();
  const span = byId<HTMLSelectElement>('span');
  const sensor = byId<HTMLSelectElement>('sensor');
  let latest: Spectrum | null = null;
  let chatter_hz: number | null = null;
  let range = { low: -60, high: 0 };
  let frequencies: number[] = [];
  let fresh = false;

  const span_hz = (): number => Number(span.value) || (frequencies.at(-1) ?? 2000);

  const drawHarmonics = (u: uPlot): void => {
    if (!latest) return;
    const { ctx, bbox } = u;
    const dpr = devicePixelRatio;
    const line = (hz: number, colour: string, dash: number[], width: number, from: number): void => {
      const x = Math.round(u.valToPos(hz, 'x', true));
      ctx.beginPath();
      ctx.setLineDash(dash.map((d) => d * dpr));
      ctx.strokeStyle = colour;
      ctx.lineWidth = width * dpr;
      ctx.moveTo(x, bbox.top + from * bbox.height);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    };
    ctx.save();
    const { spindle_hz, tooth_hz } = latest;
    const px = (hz: number): number => (hz / span_hz()) * bbox.width / dpr;
    if (spindle_hz && px(spindle_hz) > 4) {
      for (let hz = spindle_hz; hz < span_hz(); hz += spindle_hz) line(hz, look().muted, [], 1, 0.93);
    }
    if (tooth_hz && px(tooth_hz) > 4) {
      const every = Math.ceil((2.6 * look().rem) / px(tooth_hz));
      for (let k = 1; k * tooth_hz < span_hz(); k++) {
        line(k * tooth_hz, look().second, [5, 4], 1.5, 0);
        const x = u.valToPos(k * tooth_hz, 'x', true);
        if (k % every === 0 || k === 1) rimmedText(ctx, `${k}×`, x, bbox.top + 0.7 * look().rem * dpr, look().second);
      }
    }
    ctx.restore();
  };

  const drawChatter = (u: uPlot): void => {
    if (chatter_hz === null || chatter_hz > span_hz()) return;
    const { ctx, bbox } = u;
    const size = 0.55 * look().rem * devicePixelRatio;
    const x = u.valToPos(chatter_hz, 'x', true);
    ctx.save();
    ctx.fillStyle = ctx.strokeStyle = look().alarm;
    ctx.lineWidth = 2 * devicePixelRatio;
    ctx.beginPath();
    ctx.moveTo(x - size, bbox.top - 1.6 * size);
    ctx.lineTo(x + size, bbox.top - 1.6 * size);
    ctx.lineTo(x, bbox.top);
    ctx.fill();
    ctx.restore();
    const after = x < bbox.left + 0.75 * bbox.width;
    rimmedText(ctx, `chatter ${hertz(chatter_hz)}`, x + (after ? 1.5 : -1.5) * size, bbox.top - 1.2 * size,
      look().alarm, after ? 'left' : 'right');
  };

  const chart = new Chart(byId('spectrum-chart'), (l) => ({
    ...plain,
    padding: [1.4 * l.rem, rightEms * l.rem, 0, 0],
    scales: { x: { time: false, range: () => [0, span_hz()] }, y: { range: () => [range.low, range.high] } },
    axes: [
      bottomAxis(l, 'frequency, Hz'),
      sideAxis(l, 'dB re 1 m/s²'),
    ],
    series: [{}, { stroke: l.data, width: 1.5, points: { show: false } }],
    hooks: { drawClear: [drawHarmonics], draw: [drawChatter] },
  }), [[], []]);

  /** One range for chart and colours: it only grows, in steps of ten decibels, so that a level keeps its colour. */
  const widen = (levels: Float32Array): void => {
    const sorted = Float32Array.from(levels).sort();
    const floor = sorted[Math.floor(0.2 * sorted.length)] ?? -60;
    const low = Math.min(range.low, 10 * Math.floor(floor / 10) - 10);
    const high = Math.max(range.high, 10 * Math.ceil((sorted.at(-1) ?? 0) / 10));
    if (low === range.low && high === range.high) return;
    range = { low, high };
    fall.setRange(low + 10, high); // the lowest ten decibels are noise
    setText(byId('colours-low'), `${low + 10}`.replace('-', '−'));
    setText(byId('colours-high'), quantity(high, 0, 'dB'));
  };

  const restyle = (): void => {
    fall.setSpan(span_hz());
    fall.resize();
    chart.redraw();
  };
  span.addEventListener('change', restyle);
  sensor.addEventListener('change', () => fall.reset());
  new ResizeObserver(() => fall.resize()).observe(byId('waterfall'));

  return {
    show(spectrum) {
      const name = String(spectrum.sensor ?? 0);
      if (![...sensor.options].some((o) => o.value === name)) {
        sensor.add(new Option(`sensor ${Number(name) + 1}`, name));
        sensor.hidden = sensor.options.length < 2;
      }
      const { bin_hz, low_db, step_db } = spectrum;
      if (name !== sensor.value || !bin_hz || bin_hz < 0 || !spectrum.levels.length || low_db === null || step_db === null) return;
      if (frequencies.length !== spectrum.levels.length || frequencies[1] !== bin_hz) {
        frequencies = Array.from(spectrum.levels, (_, k) => k * bin_hz);
        fall.setSpan(span_hz());
      }
      latest = spectrum;
      fresh = true;
      widen(Float32Array.from(spectrum.levels, (byte) => low_db + step_db * byte));
      fall.add(spectrum);
    },

    setChatter(hz) {
      chatter_hz = hz;
    },

    frame(nowMs, smooth) {
      fall.frame(nowMs, smooth);
      if (!fresh || !latest) return;
      fresh = false;
      const { low_db, step_db, levels, tooth_hz, spindle_hz } = latest;
      chart.show([frequencies, Array.from(levels, (byte) => (low_db ?? 0) + (step_db ?? 0) * byte)]);
      setText(byId('tooth-hz'), hertz(tooth_hz));
      setText(byId('spindle-hz'), hertz(spindle_hz));
    },

    reset() {
      latest = null;
      fall.reset();
      chart.show([[], []]);
    },

    restyle,
  };
}
