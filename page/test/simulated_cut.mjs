// A cut of forty seconds as `stillcut scope` would tell it, a function of the time: air, a stable cut, chatter and its
// correction, a sensor in doubt, a fault, a second chatter whose correction meets the speed limit, air again. Lobes are
// those of two modes in one direction (Altintas and Budak's single-frequency solution); the rest is made to look alike.
export const duration_s = 40;
const teeth = 2;
const modes = [{ hz: 339, damping_ratio: 0.035, stiffness: 2.2e7 }, { hz: 688, damping_ratio: 0.022, stiffness: 3.1e7 }];
const speeds = Array.from({ length: 201 }, (_, i) => 3000 + 3 * i);
const chatter = { first: { from: 12, to: 14.1, hz: 733.1 }, second: { from: 31, to: 34.4, hz: 768.2 } };
const bins = 512;
const bin_hz = 9.765625;

/** Uniform in 0 to 1, the same for the same number (a hash of integers, after Wellons's lowbias32). */
function noise(n) {
  let x = Math.imul(n ^ (n >>> 16), 0x21f0aaad);
  x = Math.imul(x ^ (x >>> 15), 0x735a2d97);
  return ((x ^ (x >>> 15)) >>> 0) / 4294967296;
}

const between = (t, from, to) => Math.min(Math.max((t - from) / (to - from), 0), 1);
const round = (v, digits) => (v === null ? null : Number(v.toFixed(digits)));

/** The depth rises into the lobe, later falls. */
const depthAt = (t) => 0.45 + 0.52 * between(t, 9, 11.9) - 0.22 * between(t, 18, 24);

/** The posture moves: its frequencies rise by seven per cent. */
const drift = (t) => 1 + 0.07 * between(t, 26.5, 31);

/** The depth limit in mm and the chatter frequency over the speeds. */
export function lobesAt(t) {
  const limit = speeds.map(() => Infinity);
  const hz = speeds.map(() => null);
  for (let f = 280; f < 1200; f += 0.15) {
    let re = 0, im = 0;
    for (const m of modes) {
      const r = f / (m.hz * drift(t)), a = 1 - r * r, b = 2 * m.damping_ratio * r;
      re += a / (m.stiffness * (a * a + b * b));
      im -= b / (m.stiffness * (a * a + b * b));
    }
    if (re >= 0) continue;
    const a_mm = -1000 / (2 * 2.55e9 * re);
    const phase = Math.PI + 2 * Math.atan2(im, re); // between one wave and the next, atan2 in -pi to -pi/2
    for (let k = 1; k < 20; k++) {
      const rpm = (60 * f) / (teeth * (k + 1 + phase / (2 * Math.PI)));
      const i = Math.round((rpm - speeds[0]) / 3);
      if (i >= 0 && i < speeds.length && a_mm < limit[i]) [limit[i], hz[i]] = [a_mm, f];
    }
  }
  return {
    t, rpm: speeds, limit_mm: limit.map((a) => (a < 20 ? round(a, 4) : null)), chatter_hz: hz.map((f) => round(f, 1)),
    modes: modes.map((m) => ({ hz: round(m.hz * drift(t), 1), damping_ratio: m.damping_ratio })), depth_limit_unbounded: null,
  };
}

export function rpmAt(t) {
  return 3330 + 150 * between(t, 12.25, 13.6) + 120 * between(t, 31.4, 33) + 3 * Math.sin(9 * t);
}

/** Amplitude of chatter, 0 to 1. */
function amplitude(t, { from, to }) {
  return between(t, from - 1.6, from + 0.2) ** 3 * (1 - between(t, to - 0.7, to));
}

export function stateAt(t, { live = true } = {}) {
  const rpm = rpmAt(t);
  const cutting = t >= 4 && t < 37;
  const heard = amplitude(t, chatter.first) > 0.55 ? chatter.first : amplitude(t, chatter.second) > 0.55 ? chatter.second : null;
  const corrected = (t >= 12.25 && t < 31) || (t >= 31.4 && t < 37);
  const [state, reason] =
    !cutting ? ['not cutting', 'No tooth passing is heard: the tool is in the air.']
    : t >= 24 && t < 26.5 ? ['cannot tell', 'Accelerometer 1 is saturated; its spectrum is not to be trusted.']
    : t >= 26.5 && t < 28.5 ? ['fault', 'Frames are lost on CAN: 214 of the last second. Corrections are withheld.']
    : t >= 12 && t < 12.25 ? ['chatter', 'Regenerative chatter at 733 Hz, mode 2 of the posture.']
    : t >= 12.25 && t < 14.1 ? ['correcting', 'The spindle goes to 3480 rpm; chatter at 733 Hz dies down.']
    : t >= 31 && t < 31.4 ? ['chatter', 'Regenerative chatter at 768 Hz, mode 2 of the posture.']
    : t >= 31.4 && t < 34.4 ? ['correcting', 'The spindle goes to its highest speed, 3600 rpm; a better one is not allowed.']
    : (t >= 10.6 && t < 12) || (t >= 29.9 && t < 31) ? ['watch', 'The indicator nears its limit; a correction is being prepared.']
    : ['stable', t < 12 ? 'Predicted and heard to be stable at the present speed.' : 'Stable since the correction of the spindle speed.'];
  const indicator = cutting ? 0.18 + 0.04 * noise(Math.floor(20 * t)) + 1.7 * amplitude(t, chatter.first) + 1.5 * amplitude(t, chatter.second) : 0.02;
  const lobes = lobesNear(t);
  const limit = lobes.limit_mm[Math.min(Math.max(Math.round((rpm - speeds[0]) / 3), 0), 200)];
  const limited = t >= 31.4 && t < 37;
  return {
    t, state, reason, mode: live ? 'active' : 'shadow', rpm: round(rpm, 1), advised_rpm: corrected ? (limited ? 3600 : 3480) : null,
    advice: corrected ? 'spindle speed' : null, limited_by: limited ? ['speed range'] : [],
    advice_reason: corrected ? 'next lobe with the largest margin' : '', advised_direction_deg: null, feed_override: null,
    variation_ratio: null, variation_hz: null, indicator: state === 'cannot tell' ? null : round(indicator, 3),
    margin: cutting && limit !== null ? round(limit / depthAt(t) - 1, 3) : null, depth_mm: cutting ? round(depthAt(t), 4) : null,
    limit_mm: limit, chatter_hz: heard ? heard.hz : null, chatter_kind: heard ? 'regenerative' : null,
    mode_number: heard ? 2 : null, mode_hz: heard ? round(modes[1].hz * drift(t), 1) : null,
  };
}

let near = { key: -1, lobes: null };
function lobesNear(t) {
  const key = Math.floor(5 * t) / 5;
  if (near.key !== key) near = { key, lobes: lobesAt(key) };
  return near.lobes;
}

export function spectrumAt(t) {
  const spindle_hz = rpmAt(t) / 60, tooth_hz = teeth * spindle_hz, row = Math.floor(20 * t);
  const cutting = t >= 4 && t < 37;
  const power = new Float64Array(bins);
  const line = (hz, db, width = 0.7) => {
    const at = hz / bin_hz;
    for (let k = Math.max(0, Math.floor(at - 25)); k < Math.min(bins, at + 25); k++) {
      power[k] += 10 ** (db / 10) / (1 + ((k - at) / width) ** 4);
    }
  };
  for (let k = 0; k < bins; k++) {
    const hump = modes.reduce((sum, m) => sum + 12 / (1 + ((k * bin_hz - m.hz) / 60) ** 2), 0);
    const floor = -52 + (cutting ? 9 + hump : 0) - 8 * (k / bins);
    power[k] = 10 ** (floor / 10) * -Math.log(noise(row * bins + k) + 1e-9);
  }
  for (let k = 1; k <= 12; k++) line(k * spindle_hz, -30 - 3 * k);
  if (cutting) for (let k = 1; k <= 24; k++) line(k * tooth_hz, 2 - 1.6 * k + 3 * Math.sin(k));
  for (const c of [chatter.first, chatter.second]) {
    const a = amplitude(t, c);
    if (a > 0.01) for (const side of [-2, -1, 0, 1, 2]) line(c.hz + side * tooth_hz, 22 + 20 * Math.log10(a) - 9 * Math.abs(side), 1.1);
  }
  const levels = Buffer.from(power.map((p) => Math.min(Math.max(Math.round((10 * Math.log10(p) + 80) / 0.5), 0), 255)));
  return {
    t, sensor: 0, bin_hz, low_db: -80, step_db: 0.5, levels: levels.toString('base64'),
    spindle_hz: round(spindle_hz, 3), tooth_hz: round(tooth_hz, 3),
  };
}

export const events = [
  { t: 4, event: 'cut_entry', kind: '', hz: null, indicator: 0.2, rpm: 3330, note: '' },
  { t: 12, event: 'chatter_onset', kind: 'regenerative', hz: 733.1, indicator: 1.04, rpm: 3331, note: 'start=11.87' },
  { t: 14.1, event: 'chatter_end', kind: 'regenerative', hz: 733.1, indicator: 0.31, rpm: 3480, note: '' },
  { t: 26.5, event: 'fault', kind: '', hz: null, indicator: null, rpm: 3480, note: 'frames lost on CAN' },
  { t: 31, event: 'chatter_onset', kind: 'regenerative', hz: 768.2, indicator: 1.02, rpm: 3480, note: 'start=30.81' },
  { t: 34.4, event: 'chatter_end', kind: 'regenerative', hz: 768.2, indicator: 0.33, rpm: 3600, note: '' },
  { t: 37, event: 'cut_exit', kind: '', hz: null, indicator: 0.1, rpm: 3600, note: '' },
];

export const corrections = [
  { t: 12.25, sequence: 1, mode: 'active', kind: 'spindle speed', rpm_target: 3480, rpm_setpoint: 3330, feed_override: null, feed_direction_deg: null, chatter_hz: 733.1, margin_before: -0.11, margin_after: 0.32, limited_by: [], confidence_percent: 88, reason: 'next lobe with the largest margin' },
  { t: 31.4, sequence: 2, mode: 'active', kind: 'spindle speed', rpm_target: 3600, rpm_setpoint: 3480, feed_override: null, feed_direction_deg: null, chatter_hz: 768.2, margin_before: -0.1, margin_after: 0.26, limited_by: ['speed range'], confidence_percent: 41, reason: 'the best speed allowed' },
];

/** `t` runs from 0 within the cut; `total` counts seconds since the start. */
export function healthAt(t, total = t) {
  const lost = 214 * between(t, 26.5, 28.5);
  return {
    t,
    sensors: ['accelerometer 1', 'accelerometer 2'].map((name, i) => ({
      name, wanted_hz: 25600, rate_hz: round(25598.1 + 2 * i + Math.sin(t), 1),
      rate_error_percent: round((100 * (25598.1 + 2 * i + Math.sin(t) - 25600)) / 25600, 4),
      frames_lost: i ? 0 : Math.round(lost), gaps: i ? 0 : t >= 26.5 ? 3 : 0, saturated: i ? 0 : Math.round(9310 * between(t, 24, 26.5)), not_finite: 0,
    })),
    doubts: t >= 24 && t < 26.5 ? ['accelerometer saturated'] : [],
    hops: [
      { hop: 'CAN, dropped by the kernel', lost: Math.round(lost) }, { hop: 'loop to publisher', lost: 0 },
      { hop: 'LCM, status', lost: 0 }, { hop: 'DDS, telemetry', lost: total > 30 ? 2 : 0 }, { hop: 'scope to this page', lost: 0 },
    ],
  };
}

export function latencyAt(t, total = t) {
  const ticks = Math.floor(1000 * (total + 60));
  // Log-normal times with a few stragglers, counted in quarter octaves.
  const histogram = (stage, median_us, spread) => ({
    stage, first_us: 1, per_octave: 4,
    counts: Array.from({ length: 56 }, (_, i) => {
      const z = (Math.log2(2 ** ((i + 0.5) / 4) / median_us)) / spread;
      return Math.round((ticks * Math.exp(-0.5 * z * z) * 0.25) / (spread * 2.507) + (z > 3 && z < 7 ? 3 * noise(i) : 0));
    }),
  });
  const histograms = [histogram('decision', 340, 0.45), histogram('wake-up', 22, 0.4), histogram('tick', 95, 0.35)];
  const measured = histograms.map(({ stage, counts }) => {
    const count = counts.reduce((a, b) => a + b, 0);
    const at = (share) => {
      let sum = 0;
      return round(2 ** ((counts.findIndex((c) => (sum += c) >= share * count) + 0.5) / 4), 1);
    };
    let last = counts.length - 1;
    while (!counts[last]) last--;
    return { stage, count, p50_us: at(0.5), p99_us: at(0.99), p999_us: at(0.999), max_us: round(2 ** ((last + 0.8) / 4), 1) };
  });
  const parts = ['receive', 'decode', 'filter', 'transform', 'decide', 'hand-over'].map((stage, i) => (
    { stage, count: ticks, p50_us: 2.5 + i, p99_us: 20 + i, p999_us: 41 + i, max_us: 160 + i })); // as many as the daemon's
  return { t, in_time: true, times_out: 0, stages: [...measured, ...parts], histograms };
}
