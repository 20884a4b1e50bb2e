// What `stillcut scope` sends, read from JSON that is taken as unknown: a field of another type than agreed becomes
// null, an empty text or an empty list, and a message without its time is refused. Field names, with their units, are
// the server's own.

type Reader<T> = (value: unknown) => T;
type Shape = Record<string, Reader<unknown>>;
type Read<S extends Shape> = { [K in keyof S]: ReturnType<S[K]> };

const number_: Reader<number | null> = (v) => (typeof v === 'number' && Number.isFinite(v) ? v : null);
const text: Reader<string> = (v) => (typeof v === 'string' ? v : '');
const flag: Reader<boolean | null> = (v) => (typeof v === 'boolean' ? v : null);
const list =
  <T>(item: Reader<T>): Reader<T[]> =>
  (v) =>
    Array.isArray(v) ? v.map(item) : [];
const record =
  <S extends Shape>(shape: S): Reader<Read<S>> =>
  (v) => {
    const from = (typeof v === 'object' && v !== null ? v : {}) as Record<string, unknown>;
    return Object.fromEntries(Object.entries(shape).map(([key, read]) => [key, read(from[key])])) as Read<S>;
  };
const time: Reader<number> = (v) => {
  const t = number_(v);
  if (t === null) throw new TypeError('a message without its time');
  return t;
};
/** One byte a bin, base64. */
const bytes: Reader<Uint8Array> = (v) => Uint8Array.from(atob(text(v)), (c) => c.charCodeAt(0));

const mark = record({ t: time, event: text, kind: text });
const readAbout = record({
  title: text, source: text, where: text, duration_s: number_, start_utime: number_, teeth: number_,
  min_rpm: number_, max_rpm: number_, version: text, marks: list(mark),
});

const readers = {
  state: record({
    t: time, state: text, reason: text, mode: text, rpm: number_, advised_rpm: number_, advice: text,
    limited_by: list(text), advice_reason: text, advised_direction_deg: number_, feed_override: number_,
    variation_ratio: number_, variation_hz: number_, indicator: number_, margin: number_, depth_mm: number_,
    limit_mm: number_, chatter_hz: number_, chatter_kind: text, mode_number: number_, mode_hz: number_,
  }),
  spectrum: record({
    t: time, sensor: number_, bin_hz: number_, low_db: number_, step_db: number_, levels: bytes,
    spindle_hz: number_, tooth_hz: number_,
  }),
  lobes: record({
    t: time, rpm: list(number_), limit_mm: list(number_), chatter_hz: list(number_),
    modes: list(record({ hz: number_, damping_ratio: number_ })),
  }),
  event: record({ t: time, event: text, kind: text, hz: number_, indicator: number_, rpm: number_, note: text }),
  correction: record({
    t: time, sequence: number_, mode: text, kind: text, rpm_target: number_, rpm_setpoint: number_,
    feed_override: number_, feed_direction_deg: number_, chatter_hz: number_, margin_before: number_,
    margin_after: number_, limited_by: list(text), confidence_percent: number_, reason: text,
  }),
  health: record({
    t: time,
    sensors: list(record({
      name: text, wanted_hz: number_, rate_hz: number_, rate_error_percent: number_, frames_lost: number_,
      gaps: number_, saturated: number_, not_finite: number_,
    })),
    doubts: list(text),
    hops: list(record({ hop: text, lost: number_ })),
  }),
  latency: record({
    t: time, in_time: flag, times_out: number_,
    stages: list(record({
      stage: text, count: number_, p50_us: number_, p99_us: number_, p999_us: number_, max_us: number_,
    })),
    histograms: list(record({
      stage: text, first_us: number_, per_octave: number_, counts: list(number_),
    })),
  }),
  end: record({ t: time }),
};

export type Kind = keyof typeof readers;
type Of<K extends Kind> = ReturnType<(typeof readers)[K]>;
export type About = ReturnType<typeof readAbout>;
export type Mark = ReturnType<typeof mark>;
export type State = Of<'state'>;
export type Spectrum = Of<'spectrum'>;
export type Lobes = Of<'lobes'>;
export type MachineEvent = Of<'event'>;
export type Correction = Of<'correction'>;
export type Health = Of<'health'>;
export type Latency = Of<'latency'>;
export type Message = { [K in Kind]: { kind: K; value: Of<K> } }[Kind];

export const kinds = Object.keys(readers) as Kind[];

/** Reads the data of one server-sent event; throws where it is no JSON or has no time. */
export function readMessage(kind: Kind, data: string): Message {
  return { kind, value: readers[kind](JSON.parse(data)) } as Message;
}

/** Asks the server what is shown; throws where it does not answer. */
export async function fetchAbout(): Promise<About> {
  const answer = await fetch('api/about', { cache: 'no-store' });
  if (!answer.ok) throw new Error(`api/about: ${answer.status}`);
  return readAbout(await answer.json());
}
