// Health of the sensors and of every place where data can be lost on the way. What is not as it should be is marked.
import { byId, fillRows, make, setText } from './dom';
import { fixed } from './format';
import type { Health } from './protocol';

const rateErrorMarked_percent = 0.5;

/** A count that should be nought. */
const lossy = (count: number | null): string => (count ? `!${fixed(count, 0)}` : fixed(count, 0));

export function healthPanel(): { show(health: Health): void } {
  let doubts = '';
  return {
    show(health) {
      byId('sensors').closest('.panel')?.classList.remove('empty');
      const { sensors } = health;
      const off = (s: Health['sensors'][number]): boolean =>
        Math.abs(s.rate_error_percent ?? 0) > rateErrorMarked_percent || s.rate_hz === 0;
      fillRows(byId('sensors'), [
        ['', ...sensors.map((s) => s.name)],
        ['rate, Hz', ...sensors.map((s) => `${off(s) ? '!' : ''}${fixed(s.rate_hz, 0)}`)],
        ['rate error, %', ...sensors.map((s) => fixed(s.rate_error_percent, Math.abs(s.rate_error_percent ?? 0) < 10 ? 3 : 0))],
        ['frames lost', ...sensors.map((s) => lossy(s.frames_lost))],
        ['gaps', ...sensors.map((s) => lossy(s.gaps))],
        ['samples saturated', ...sensors.map((s) => lossy(s.saturated))],
        ['samples not finite', ...sensors.map((s) => lossy(s.not_finite))],
      ]);
      const lossyFirst = [...health.hops].sort((a, b) => Number(Boolean(b.lost)) - Number(Boolean(a.lost)));
      fillRows(byId('hops'), lossyFirst.map((h) => [h.hop, lossy(h.lost)]));
      if (doubts !== health.doubts.join()) {
        doubts = health.doubts.join();
        byId('doubts').replaceChildren(...health.doubts.map((d) => make('li', 'marked', `⚠\u00a0${d}`)));
      }
      const sum = (counts: (number | null)[]): number => counts.reduce<number>((total, n) => total + (n ?? 0), 0);
      const missing = sum(sensors.map((s) => s.frames_lost));
      const lost = sum(health.hops.map((h) => h.lost));
      setText(byId('health-summary'), [
        health.doubts.length ? 'signals in doubt' : '',
        missing ? `${fixed(missing, 0)} frames missing` : '',
        lost ? `${fixed(lost, 0)} lost on the way` : '',
      ].filter(Boolean).join(', ') || 'nothing lost, no doubts');
    },
  };
}
