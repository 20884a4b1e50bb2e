// Corrections and events, newest first: what was asked, why, how much better it is predicted to be, which limits were met.
import { byId, make } from './dom';
import { clock, hertz, percent, quantity, sentence } from './format';
import type { About, Correction, MachineEvent } from './protocol';

const entriesKept = 60;

export interface LogPanel {
  addCorrection(correction: Correction): void;
  addEvent(event: MachineEvent): void;
  frame(): void;
  reset(): void;
}

type Entry = { t: number; key: string; element: HTMLElement };

const eventWords: Record<string, string> = {
  cut_entry: 'cut begins',
  cut_exit: 'cut ends',
  chatter_onset: 'chatter begins',
  chatter_end: 'chatter is over',
  forced_vibration: 'forced vibration',
  fault: 'fault',
};

export function logPanel(about: About): LogPanel {
  const host = byId('log');
  const live = about.source === 'daemon';
  let entries: Entry[] = [];
  let fresh = false;

  const add = (t: number, key: string, ...content: HTMLElement[]): void => {
    if (entries.some((e) => e.key === key)) return; // the server sends the last ones again on connecting
    const time = make('span', 'time', clock(t, live));
    entries.push({ t, key, element: make('li', '', time, make('div', '', ...content)) });
    entries.sort((a, b) => b.t - a.t);
    entries.splice(entriesKept);
    fresh = true;
  };

  return {
    addCorrection(c) {
      const details = [
        c.chatter_hz === null ? '' : `chatter ${hertz(c.chatter_hz)}`,
        c.margin_after === null ? '' : `margin ${percent(c.margin_before, 0, true)} → ${percent(c.margin_after, 0, true)}`,
        c.confidence_percent === null || c.kind === 'release' ? '' : `confidence ${quantity(c.confidence_percent, 0, '%')}`,
      ].filter(Boolean);
      const content = [
        make('strong', '', target(c)),
        make('span', `tag ${c.mode}`, c.mode === 'active' ? 'sent' : 'shadow, not sent'),
        make('p', '', details.join(' · ')),
      ];
      if (c.limited_by.length) content.push(make('p', 'limits', `⚠ limited by ${c.limited_by.join(', ')}`));
      add(c.t, `correction ${c.t} ${c.sequence}`, ...content);
    },

    addEvent(e) {
      if (e.event === 'correction') return; // told by the correction itself
      const about_it = [e.kind, e.hz === null ? '' : hertz(e.hz), e.note].filter(Boolean).join(', ');
      const words = sentence(eventWords[e.event] ?? e.event.replaceAll('_', ' '));
      add(e.t, `${e.event} ${e.t} ${e.kind}`, make('span', `event ${e.event}`, about_it ? `${words}: ${about_it}` : words));
    },

    frame() {
      if (!fresh) return;
      fresh = false;
      host.replaceChildren(...entries.map((e) => e.element));
      byId('log-empty').hidden = entries.length > 0;
    },

    reset() {
      entries = [];
      fresh = true;
    },
  };
}

function target(c: Correction): string {
  switch (c.kind) {
    case 'spindle speed':
      return `Spindle speed → ${quantity(c.rpm_target, 0, 'rpm')}`;
    case 'feed direction':
      return `Feed direction → ${quantity(c.feed_direction_deg, 0, '°')}`;
    case 'feed override':
      return `Feed → ${percent(c.feed_override)}`;
    default:
      return sentence(c.kind || 'correction');
  }
}
