// How each state looks: told by its word, by the outline and sign of its symbol, and by colour last.

export interface Face {
  outline: string; // path in a square of 100
  sign: string; // stroked
  loud: boolean; // fills the whole panel: somebody should look
  text: string; // for those who know the word only
}

const circle = 'M50 4a46 46 0 1 0 .01 0z';
const pill = 'M26 28H74a22 22 0 0 1 0 44H26a22 22 0 0 1 0-44z';
const triangle = 'M50 5L97 92H3z';
const octagon = 'M31 4H69L96 31V69L69 96H31L4 69V31z';
const arrow = 'M4 22H52V4L97 50L52 96V78H4z';
const diamond = 'M50 3L97 50L50 97L3 50z';
const square = 'M8 8H92V92H8z';
const query = 'M37 40a13.500 13.500 0 1 1 19 12q-6 4-6 11M50 76v1';

const faces: Record<string, Face> = {
  stable: { outline: circle, sign: 'M27 52L44 69L75 35', loud: false, text: 'the cut is stable' },
  watch: { outline: triangle, sign: 'M50 36V62M50 77v1', loud: false, text: 'near the alarm limit' },
  chatter: { outline: octagon, sign: 'M20 50L32 26L44 74L56 26L68 74L80 50', loud: true, text: 'the tool chatters' },
  correcting: { outline: arrow, sign: 'M20 50H76M58 32L76 50L58 68', loud: true, text: 'a correction is under way' },
  'cannot tell': { outline: diamond, sign: query, loud: false, text: 'the signals do not allow a judgement' },
  fault: { outline: square, sign: 'M28 28L72 72M72 28L28 72', loud: true, text: 'something is broken' },
  'not cutting': { outline: pill, sign: 'M32 50H68', loud: false, text: 'the tool is in the air' },
  'no daemon': { outline: circle, sign: 'M20 80L80 20', loud: false, text: 'nothing is heard of stillcutd' },
  'no data': { outline: square, sign: 'M26 50v1M50 50v1M74 50v1', loud: false, text: 'the page hears nothing from its server' },
};

/** The states in order of the help, `no data` being the page's own. */
export const stateWords = Object.keys(faces);

/** A state that this page does not know is shown by its word, with the symbol of doubt. */
export function faceOf(state: string): Face {
  return faces[state] ?? (faces['cannot tell'] as Face);
}

/** The class of a state's colours in the style sheet. */
export function classOf(state: string): string {
  return state in faces ? state.replaceAll(' ', '-') : 'cannot-tell';
}

const svg = 'http://www.w3.org/2000/svg';

/** Makes a state's symbol, or changes the one given. */
export function symbol(state: string, into?: SVGSVGElement): SVGSVGElement {
  const element = into ?? document.createElementNS(svg, 'svg');
  if (!into) {
    element.setAttribute('viewBox', '0 0 100 100');
    element.setAttribute('aria-hidden', 'true');
    element.append(document.createElementNS(svg, 'path'), document.createElementNS(svg, 'path'));
  }
  const face = faceOf(state);
  element.setAttribute('class', `symbol ${classOf(state)}`);
  element.children[0]?.setAttribute('d', face.outline);
  element.children[1]?.setAttribute('d', face.sign);
  return element;
}
