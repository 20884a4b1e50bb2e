// The large state with its reason, and the figures beside it.
import { byId, setClass, setText } from './dom';
import { depth, fixed, hertz, percent, quantity, sentence } from './format';
import type { State } from './protocol';
import { classOf, faceOf, symbol } from './states';

const modes: Record<string, string> = {
  off: 'corrections off',
  shadow: 'shadow: corrections are shown, none is sent',
  active: 'active: corrections are sent to the robot',
  measure: 'measuring',
};

export interface StatePanel {
  show(state: State): void;
  /** Nothing is heard: the state is not known, whatever it was. */
  showNoData(reason: string): void;
}

export function statePanel(): StatePanel {
  const panel = byId('state');
  const icon = symbol('no data');
  byId('state-symbol').append(icon);
  const announced = byId('announced');
  let told = '';

  const face = (state: string, reason: string): void => {
    setClass(panel, `panel ${classOf(state)}${faceOf(state).loud ? ' loud' : ''}`);
    if (state !== told) symbol(state, icon);
    setText(byId('state-word'), sentence(state));
    setText(byId('state-reason'), /^\p{Ll}{2}/u.test(reason) ? sentence(reason) : reason); // not `n = 60 f / k`
    if (state !== told) {
      document.title = `${sentence(state)} · ${document.body.dataset['title'] ?? 'Stillcut'}`;
      setText(announced, `State: ${state}. ${reason}`); // once a change: a reason that counts up is not read aloud
      told = state;
    }
  };

  return {
    show(state) {
      face(state.state, state.reason);
      setText(byId('mode'), modes[state.mode] ?? state.mode);
      setClass(byId('mode'), `chip ${state.mode}`);
      setText(byId('rpm'), fixed(state.rpm, 0));
      setText(byId('advice'), advice(state));
      setText(byId('limited-by'), state.limited_by.length ? `⚠ limited by ${state.limited_by.join(', ')}` : '');
      setText(byId('chatter-hz'), fixed(state.chatter_hz, state.chatter_hz !== null && state.chatter_hz < 100 ? 1 : 0));
      setText(byId('chatter-kind'), state.chatter_hz === null ? 'none heard' : chatterKind(state.chatter_kind));
      setText(byId('mode-number'), state.mode_number === null
        ? '' : `mode ${state.mode_number}${state.mode_hz === null ? '' : `, ${hertz(state.mode_hz)}`}`);
      setText(byId('depth'), depth(state.depth_mm));
      setText(byId('limit'), state.limit_mm === null ? 'limit not known or unbounded' : `limit ${depth(state.limit_mm)}\u00a0mm`);
      setText(byId('margin'), state.margin === null ? '' : `margin ${percent(state.margin, 0, true)}`);
      setText(byId('indicator'), fixed(state.indicator, 2));
      const bar = byId('indicator-bar');
      bar.style.transform = `scaleX(${Math.min(Math.max((state.indicator ?? 0) / 1.5, 0), 1)})`;
      setClass(bar, (state.indicator ?? 0) >= 1 ? 'above' : '');
    },
    showNoData(reason) {
      face('no data', reason);
    },
  };
}

function chatterKind(kind: string): string {
  return kind === '' || kind === 'unknown' ? 'kind unknown' : kind;
}

/** What is advised, in the words of the tile below the speed. */
export function advice(state: State): string {
  switch (state.advice) {
    case 'spindle speed':
      return `→ advised ${quantity(state.advised_rpm, 0, 'rpm')}`;
    case 'spindle speed variation':
      return `→ vary ±${percent(state.variation_ratio)}, ${quantity(state.variation_hz, 1, 'Hz')}`;
    case 'feed direction':
      return `→ advised feed direction ${quantity(state.advised_direction_deg, 0, '°')}`;
    case 'feed override':
      return `→ advised feed ${percent(state.feed_override)}`;
    case 'stop request':
      return '→ advised: stop';
    case 'release':
      return 'released to the nominal speed';
    case '':
      return 'no change advised';
    default:
      return `→ ${state.advice}`;
  }
}
