/** @file Colours: the page's own, from its style sheet, and tints of bodies, chosen so that the colour-blind can
 * tell them apart. */

const NAMES = ["paper", "ink", "faint", "line", "panel", "accent", "positive", "negative", "force", "moment"];
const HUES = [
  [205, 45],
  [28, 60],
  [160, 38],
  [325, 35],
  [48, 50],
  [265, 30],
  [190, 20],
  [95, 28],
];
export const SHADES = 12;

/** Read the colours of the style sheet, light or dark. @returns {Record<string, string> & {dark: boolean}} */
export function readColours() {
  const style = getComputedStyle(document.documentElement);
  const found = { dark: matchMedia("(prefers-color-scheme: dark)").matches };
  for (const name of NAMES) found[name] = style.getPropertyValue(`--${name}`).trim();
  return found;
}

const made = new Map();
/** @type {WeakMap<object, number[]>} the kinds of the bodies of each scene */
const bodyKinds = new WeakMap();

/** Get the number of each body's kind: bodies whose names differ in digits alone share a colour. */
export function getBodyKinds(scene) {
  if (!bodyKinds.has(scene)) {
    const known = new Map();
    const kinds = scene.bodies.map(({ name }) => {
      const kind = name.replace(/[\d_ .-]+/g, "") || name;
      if (!known.has(kind)) known.set(kind, known.size);
      return known.get(kind);
    });
    bodyKinds.set(scene, kinds);
  }
  return bodyKinds.get(scene);
}

/**
 * Get the colours of a kind of body: shades from dark to bright, and one for its edges.
 * @param {number} k @param {boolean} dark
 */
export function getTints(k, dark) {
  const key = 2 * (k % HUES.length) + Number(dark);
  if (!made.has(key)) made.set(key, mixTints(k, dark));
  return made.get(key);
}

function mixTints(k, dark) {
  const [hue, rich] = HUES[k % HUES.length];
  const [low, high] = dark ? [24, 52] : [52, 88];
  const shades = [];
  for (let i = 0; i < SHADES; i += 1) {
    shades.push(`hsl(${hue} ${rich}% ${(low + ((high - low) * i) / (SHADES - 1)).toFixed(1)}%)`);
  }
  return {
    shades,
    edge: `hsl(${hue} ${rich}% ${dark ? 78 : 27}%)`,
    bar: `hsl(${hue} ${rich + 8}% ${dark ? 55 : 58}%)`,
  };
}
