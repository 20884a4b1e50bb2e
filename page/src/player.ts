// Plays a recording: where it is, how fast, and the marks on it. The stream is opened anew for each seek.
import { byId, make, setText } from './dom';
import { fixed, quantity, sentence } from './format';
import type { About } from './protocol';

const step_s = 1;
const settleMs = 150; // keys held down and drags: the stream is opened where they end

export interface Player {
  readonly playing: boolean;
  readonly speed: number;
  readonly position_s: number;
  /** The stream has come to `t`. */
  moved(t: number): void;
  ended(): void;
  toggle(): void;
  seek(to_s: number): void;
  seekBy(steps: number): void;
  seekMark(direction: 1 | -1): void;
  faster(direction: 1 | -1): void;
}

/** `changed` is called when another stream is wanted, or none; `cleared` says whether what is shown no longer holds. */
export function player(about: About, changed: (cleared: boolean) => void): Player {
  const duration_s = about.duration_s ?? 0;
  const range = byId<HTMLInputElement>('position');
  const speeds = byId<HTMLSelectElement>('speed');
  const button = byId('play');
  let position_s = 0;
  let playing = true;
  let atEnd = false;
  let dragged = false;
  let held = false;
  let timer = 0;

  const draw = (): void => {
    setText(button, playing ? 'Pause' : 'Play');
    button.classList.toggle('playing', playing);
    range.value = String(position_s);
    range.setAttribute('aria-valuetext', `${fixed(position_s, 1)} of ${fixed(duration_s, 1)} seconds`);
    setText(byId('time'), `${fixed(position_s, 1)} / ${quantity(duration_s, 1, 's')}`);
  };

  const seek = (to_s: number): void => {
    position_s = Math.min(Math.max(to_s, 0), duration_s);
    atEnd = false;
    draw();
    window.clearTimeout(timer);
    timer = window.setTimeout(() => {
      dragged = false;
      changed(true);
    }, settleMs);
    dragged = true; // until then what arrives belongs to the old place
  };

  const toggle = (): void => {
    playing = !playing;
    const again = playing && atEnd;
    if (again) position_s = 0;
    atEnd = false;
    draw();
    changed(again);
  };

  range.max = String(duration_s);
  range.addEventListener('input', () => seek(Number(range.value)));
  range.addEventListener('pointerdown', () => {
    held = true; // nor does playing pull the thumb away
  });
  window.addEventListener('pointerup', () => {
    held = false;
  });
  button.addEventListener('click', toggle);
  speeds.addEventListener('change', () => changed(false));
  for (const m of about.marks) {
    const at = make('button', `mark ${m.event}`);
    at.style.left = `${(100 * m.t) / Math.max(duration_s, 1e-9)}%`;
    at.title = `${sentence(m.event.replaceAll('_', ' '))}${m.kind ? `, ${m.kind}` : ''}, ${quantity(m.t, 1, 's')}`;
    at.setAttribute('aria-label', at.title);
    at.tabIndex = -1; // many: the keys p and n go through them
    at.addEventListener('click', () => seek(m.t));
    byId('marks').append(at);
  }
  byId('player').hidden = false;
  draw();

  return {
    get playing() {
      return playing;
    },
    get speed() {
      return Number(speeds.value);
    },
    get position_s() {
      return position_s;
    },
    moved(t) {
      if (dragged || held || !playing) return;
      position_s = Math.min(Math.max(t, 0), duration_s);
      draw();
    },
    ended() {
      playing = false;
      atEnd = true;
      position_s = duration_s;
      draw();
    },
    toggle,
    seek,
    seekBy: (steps) => seek(position_s + steps * step_s),
    seekMark(direction) {
      // Back from just behind a mark goes to the one before it.
      const sorted = about.marks.map((m) => m.t).sort((a, b) => direction * (a - b));
      const next = sorted.find((t) => direction * (t - position_s) > (direction > 0 ? 0.05 : 0.5));
      if (next !== undefined) seek(next);
    },
    faster(direction) {
      const to = speeds.selectedIndex + direction;
      if (to < 0 || to >= speeds.options.length) return;
      speeds.selectedIndex = to;
      changed(false);
    },
  };
}
