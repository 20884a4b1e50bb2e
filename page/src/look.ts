// What panels drawn on canvas take from the style sheet, and the map of colours of the waterfall.

export interface Look {
  rem: number; // CSS pixels
  font: string; // of labels, CSS pixels
  text: string;
  muted: string;
  line: string;
  surface: string;
  ground: string;
  data: string;
  second: string;
  alarm: string;
  stable: string;
}

let current: Look | null = null;

/** Colours and sizes of the theme in force. */
export function look(): Look {
  if (current) return current;
  const style = getComputedStyle(document.documentElement);
  const rem = parseFloat(style.fontSize);
  const colour = (name: string): string => style.getPropertyValue(`--${name}`).trim();
  current = {
    rem,
    font: `${Math.round(0.85 * rem)}px ${getComputedStyle(document.body).fontFamily}`,
    text: colour('text'), muted: colour('muted'), line: colour('line'), surface: colour('surface'), ground: colour('ground'),
    data: colour('data'), second: colour('second'), alarm: colour('alarm'), stable: colour('stable'),
  };
  return current;
}

/** To be called when theme or size may have changed. */
export function forgetLook(): void {
  current = null;
}

// Viridis (van der Walt and Smith 2015): even in lightness, and so read alike with every colour vision and in grey.
const viridis = [0x440154, 0x482878, 0x3e4989, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725];

/** Colours for 0 to 255 as pixels of an ImageData (little endian, opaque). */
export const waterfallColours: Uint32Array = Uint32Array.from({ length: 256 }, (_, i) => {
  const at = (i / 255) * (viridis.length - 1);
  const k = Math.min(Math.floor(at), viridis.length - 2);
  const [low = 0, high = 0] = [viridis[k], viridis[k + 1]];
  const mix = (shift: number): number =>
    Math.round(((low >> shift) & 255) * (k + 1 - at) + ((high >> shift) & 255) * (at - k));
  return ((255 << 24) | (mix(0) << 16) | (mix(8) << 8) | mix(16)) >>> 0;
});

/** Text on a canvas with a rim of the ground's colour, so that it can be read over lines. `x`, `y` in device pixels. */
export function rimmedText(
  ctx: CanvasRenderingContext2D, words: string, x: number, y: number, colour: string, align: CanvasTextAlign = 'center',
): void {
  const dpr = devicePixelRatio;
  ctx.save();
  ctx.font = look().font.replace(/^(\d+)px/, (_, px: string) => `${Number(px) * dpr}px`);
  ctx.textAlign = align;
  ctx.textBaseline = 'middle';
  ctx.lineJoin = 'round';
  ctx.lineWidth = 4 * dpr;
  ctx.strokeStyle = look().surface;
  ctx.strokeText(words, x, y);
  ctx.fillStyle = colour;
  ctx.fillText(words, x, y);
  ctx.restore();
}
