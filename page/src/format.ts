// Numbers as people read them: with unit, a real minus sign, and a dash where nothing is known.

const dash = '–';

/** `digits` behind the point; a narrow space between thousands from 10 000 on. */
export function fixed(value: number | null, digits: number): string {
  if (value === null) return dash;
  const [whole = '', part] = Math.abs(value).toFixed(digits).split('.');
  const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, '\u202f') : whole;
  const zero = !/[1-9]/.test(whole + (part ?? ''));
  return (value < 0 && !zero ? '\u2212' : '') + grouped + (part === undefined ? '' : `.${part}`);
}

/** A value and its unit, kept on one line. */
export function quantity(value: number | null, digits: number, unit: string): string {
  return value === null ? dash : `${fixed(value, digits)}\u00a0${unit}`;
}

/** A frequency: as many digits as a person can use. */
export function hertz(value: number | null): string {
  return quantity(value, value !== null && Math.abs(value) < 100 ? 1 : 0, 'Hz');
}

/** A depth of cut in millimetres: three figures. */
export function depth(value: number | null): string {
  return fixed(value, value !== null && Math.abs(value) < 1 ? 3 : 2);
}

/** A ratio as a percentage, with its sign if asked. */
export function percent(ratio: number | null, digits = 0, signed = false): string {
  if (ratio === null) return dash;
  return (signed && ratio > 0 ? '+' : '') + quantity(100 * ratio, digits, '%');
}

/** A time given in microseconds, in the unit that suits it. */
export function microseconds(value: number | null): string {
  if (value === null) return dash;
  const [scaled, unit] = value < 1e3 ? [value, 'µs'] : value < 1e6 ? [value / 1e3, 'ms'] : [value / 1e6, 's'];
  return quantity(scaled, scaled < 9.95 ? (unit === 'µs' ? 1 : 2) : scaled < 99.5 ? 1 : 0, unit);
}

/** A point in time: of the day for a live stream, from its beginning for a recording. */
export function clock(t: number, live: boolean, digits = 1): string {
  if (!live) return `${fixed(t, digits)}\u00a0s`;
  const at = new Date(1000 * t);
  return [at.getHours(), at.getMinutes(), at.getSeconds()].map((n) => String(n).padStart(2, '0')).join(':');
}

/** First letter large. */
export function sentence(words: string): string {
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** The next larger 1, 1.5, 2, 3, 4, 5, 6 or 8 times a power of ten, for ends of axes that seldom change. */
export function niceCeil(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const step = [1, 1.5, 2, 3, 4, 5, 6, 8, 10].find((s) => s * power >= value * (1 - 1e-9)) ?? 10;
  return step * power;
}
