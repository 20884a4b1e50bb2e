// Health of the sensors and of every place where data can be lost on the way. What is not as it should be is marked.
import { byId, fillRows, make, setText } from './dom';
import { fixed, quantity } from './format';
import type { Health } from './protocol';

const rateErrorMarked_percent = 0.5;

/** A count that should be nought. */
const lossy = (count: number | null): string => (count ? `!${fixed(count, 0)}` : fixed(count, 0));

export function healthPanel(): { show(health: Health): void } {
  let doubts = '';
  return {
    show(health) {
      fillRows(byId('sensors'), health.sensors.map((s) => {
        const off = Math.abs(s.rate_error_percent ?? 0) > rateErrorMarked_percent || s.rate_hz === 0;
        return [
          s.name,
          `${off ? '!' : ''}${quantity(s.rate_hz, 0, 'Hz')}`,
          quantity(s.rate_error_percent, Math.abs(s.rate_error_percent ?? 0) < 10 ? 3 : 0, '%'),
          lossy(s.frames_lost), lossy(s.gaps), lossy(s.saturated), lossy(s.not_finite),
        ];
      }));
      fillRows(byId('hops'), health.hops.map((h) => [h.hop, lossy(h.lost)]));
      if (doubts !== health.doubts.join()) {
        doubts = health.doubts.join();
        byId('doubts').replaceChildren(...health.doubts.map((d) => make('li', 'marked', `⚠\u00a0${d}`)));
      }
      const lost = [...health.sensors.map((s) => s.frames_lost), ...health.hops.map((h) => h.lost)]
        .reduce<number>((sum, n) => sum + (n ?? 0), 0);
      setText(byId('health-summary'), health.doubts.length || lost
        ? [health.doubts.length ? 'signals in doubt' : '', lost ? `${fixed(lost, 0)} lost on the way` : ''].filter(Boolean).join(', ')
        : 'nothing lost, no doubts');
    },
  };
}
