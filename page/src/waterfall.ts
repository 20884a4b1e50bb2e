// The waterfall: a ring of spectra, one row each, newest on top, that scrolls by the screen's clock between the spectra.
// Rows are coloured once into an off-screen canvas; a frame copies two pieces of it.
import { rightEms, sideEms } from './chart';
import { byId } from './dom';
import { look, rimmedText, waterfallColours } from './look';
import type { Spectrum } from './protocol';

const rowsKept = 256;
const rowsShown = 200; // ten seconds at 20 Hz
const nominalRow_s = 0.05;
const behindRows = 1; // shown behind what was heard, so that a late row stops nothing

export interface Waterfall {
  add(spectrum: Spectrum): void;
  frame(nowMs: number, smooth: boolean): void;
  /** Colours of levels run over these decibels. */
  setRange(low_db: number, high_db: number): void;
  setSpan(max_hz: number): void;
  reset(): void;
  resize(): void;
}

export function waterfall(): Waterfall {
  const canvas = byId<HTMLCanvasElement>('waterfall');
  const ctx = canvas.getContext('2d', { alpha: false }) as CanvasRenderingContext2D;
  const ring = document.createElement('canvas');
  const ringCtx = ring.getContext('2d') as CanvasRenderingContext2D;
  let levels = new Float32Array(0); // dB, a row each; NaN: nothing heard
  let bins = 0;
  let bin_hz = 1;
  let newest = 0; // rows added so far
  let newest_s = 0; // data time of the newest
  let row_s = nominalRow_s;
  let steps: number[] = [];
  let shown = 0; // the row at the top edge, in fractions
  let drawn = -1;
  let lastMs = 0;
  let heardMs = 0;
  let rate_hz = 1 / nominalRow_s; // of rows, on the screen's clock
  let low = -60;
  let high = 0;
  let span_hz = 0;
  let dirty = true;

  // Later rows stand higher: row i in slot rowsKept - 1 - i mod rowsKept.
  const slot = (row: number): number => rowsKept - 1 - (row % rowsKept);

  const paint = (row: number): void => {
    const image = ringCtx.createImageData(bins, 1);
    const pixels = new Uint32Array(image.data.buffer);
    const from = (row % rowsKept) * bins;
    const scale = 255 / (high - low);
    for (let i = 0; i < bins; i++) {
      const level = levels[from + i] as number;
      const index = Math.min(Math.max(Math.round((level - low) * scale), 0), 255);
      pixels[i] = level === level ? (waterfallColours[index] as number) : 0; // see-through
    }
    ringCtx.putImageData(image, 0, slot(row));
  };

  const repaint = (): void => {
    if (!bins) return;
    ringCtx.clearRect(0, 0, bins, rowsKept);
    for (let row = Math.max(0, newest - rowsKept); row < newest; row++) paint(row);
    dirty = true;
  };

  const append = (row: Float32Array | null): void => {
    const from = (newest % rowsKept) * bins;
    if (row) levels.set(row, from);
    else levels.fill(NaN, from, from + bins);
    paint(newest++);
  };

  /** The usual step between rows in data time: a recording played fast may send each spectrum, or fewer. */
  const usual = (step_s: number): number => {
    steps = [...steps.slice(-14), step_s];
    return [...steps].sort((a, b) => a - b)[steps.length >> 1] as number;
  };

  const reset = (): void => {
    steps = [];
    levels.fill(NaN);
    newest = shown = newest_s = 0;
    drawn = -1;
    repaint();
  };

  const drawAxis = (left: number, height: number): void => {
    ctx.fillStyle = look().surface;
    ctx.fillRect(0, 0, left, canvas.height);
    const whole_s = rowsShown * row_s;
    const step = [0.5, 1, 2, 5, 10, 20, 50, 100, 200].find((s) => (s / whole_s) * height > 2.5 * look().rem * devicePixelRatio);
    for (let s = 0; step && s < whole_s; s += step) {
      const edge = 0.6 * look().rem * devicePixelRatio;
      const y = Math.max((s / whole_s) * height, edge);
      if (y > height - edge) break;
      rimmedText(ctx, s ? `−${s} s` : 'now', left - 6 * devicePixelRatio, y, look().muted, 'right');
    }
  };

  const drawEmpty = (): void => {
    ctx.fillStyle = look().ground;
    ctx.fillRect(0, 0, canvas.width, canvas.height);
    drawAxis(Math.round(sideEms * look().rem * devicePixelRatio), canvas.height);
    ctx.fillRect(canvas.width - Math.round(rightEms * look().rem * devicePixelRatio), 0, canvas.width, canvas.height);
    dirty = false;
  };

  return {
    add(spectrum) {
      const { bin_hz: hz, low_db, step_db, levels: data } = spectrum;
      if (hz === null || low_db === null || step_db === null || !data.length) return;
      if (data.length !== bins || hz !== bin_hz) {
        bins = data.length;
        bin_hz = hz;
        levels = new Float32Array(bins * rowsKept);
        ring.width = bins;
        ring.height = rowsKept;
        reset();
      }
      // A gap in the data is a gap in the picture, so that its scale of time holds.
      const step_s = spectrum.t - newest_s;
      if (newest && step_s > 0) row_s = usual(step_s);
      const missed = newest ? Math.round(step_s / row_s) - 1 : 0;
      if (missed >= 2) for (let i = 0; i < Math.min(missed, rowsKept); i++) append(null);
      append(Float32Array.from(data, (byte) => low_db + step_db * byte));
      newest_s = spectrum.t;
      const nowMs = performance.now();
      const gapMs = nowMs - heardMs;
      if (gapMs < 2000) rate_hz += 0.1 * (1000 / Math.max(gapMs, 5) - rate_hz);
      heardMs = nowMs;
      dirty = true;
    },

    frame(nowMs, smooth) {
      const dt = Math.min((nowMs - lastMs) / 1000, 0.1);
      lastMs = nowMs;
      if (!bins) {
        if (dirty) drawEmpty();
        return;
      }
      if (smooth) {
        shown += rate_hz * dt; // the flow, and a gentle pull to where it should be
        shown += (newest - behindRows - shown) * Math.min(1, 2 * dt);
        shown = Math.min(Math.max(shown, newest - 4), newest);
      } else if (newest - shown >= 10 || dirty) {
        shown = newest - (newest % 10); // reduced motion: twice a second
      }
      if (shown === drawn && !dirty) return;
      drawn = shown;
      const dpr = devicePixelRatio;
      const left = Math.round(sideEms * look().rem * dpr);
      const right = Math.round(rightEms * look().rem * dpr);
      const width = canvas.width - left - right;
      const rowPx = canvas.height / rowsShown;
      const wide = Math.min(bins, span_hz / bin_hz);
      const columns = Math.round(width * (wide * bin_hz) / span_hz);
      const top = slot(newest - 1);
      const y = (shown - newest) * rowPx;
      ctx.save();
      ctx.beginPath();
      ctx.rect(left, 0, width, canvas.height);
      ctx.clip();
      ctx.fillStyle = look().ground;
      ctx.fillRect(left, 0, width, canvas.height);
      const upper = rowsKept - top; // rows from the newest to the end of the ring
      ctx.drawImage(ring, 0, top, wide, upper, left, y, columns, upper * rowPx);
      if (top) ctx.drawImage(ring, 0, 0, wide, top, left, y + upper * rowPx, columns, top * rowPx);
      ctx.restore();
      if (dirty) {
        drawAxis(left, canvas.height);
        ctx.fillStyle = look().surface;
        ctx.fillRect(canvas.width - right, 0, right, canvas.height);
      }
      dirty = false;
      canvas.dataset['frames'] = String(Number(canvas.dataset['frames'] ?? 0) + 1); // counted by tests and benchmark
    },

    setRange(low_db, high_db) {
      if (low_db === low && high_db === high) return;
      [low, high] = [low_db, high_db];
      repaint();
    },

    setSpan(max_hz) {
      span_hz = max_hz;
      dirty = true;
    },

    reset,

    resize() {
      const dpr = devicePixelRatio;
      const width = Math.round(canvas.clientWidth * dpr);
      const height = Math.round(canvas.clientHeight * dpr);
      if (width === canvas.width && height === canvas.height) return;
      [canvas.width, canvas.height] = [width, height];
      dirty = true;
    },
  };
}
