/** @file Encodes an animated GIF: one palette of the commonest colours, and of each picture only the pixels that
 * change. */

const MAX_COLOURS = 255; // the last number of a palette is that of "as before"
const UNCHANGED = 255;
const SAMPLES = 12; // pictures whose colours are counted
const LONGEST_CODE = 4096;

/** Reduce a colour to five bits each of red, green and blue, as one number. */
const reduceColour = (data, i) => ((data[i] >> 3) << 10) | ((data[i + 1] >> 3) << 5) | (data[i + 2] >> 3);

/** Choose the commonest colours, [red, green, blue] each. @param {Uint8ClampedArray[]} pictures */
function choosePalette(pictures) {
  const counts = new Map();
  const step = Math.max(1, Math.floor(pictures.length / SAMPLES));
  for (let k = 0; k < pictures.length; k += step) {
    for (let i = 0; i < pictures[k].length; i += 4) {
      const key = reduceColour(pictures[k], i);
      const found = counts.get(key);
      if (found) found[3] += 1;
      else counts.set(key, [pictures[k][i], pictures[k][i + 1], pictures[k][i + 2], 1]);
    }
  }
  const sorted = [...counts.values()].sort((a, b) => b[3] - a[3]);
  return sorted.slice(0, MAX_COLOURS).map(([red, green, blue]) => [red, green, blue]);
}

/** Make the function that finds the number of the nearest colour of a palette. */
function makeColourFinder(palette) {
  const known = new Map();
  return (data, i) => {
    const key = reduceColour(data, i);
    if (!known.has(key)) {
      let [best, least] = [0, Infinity];
      palette.forEach(([r, g, b], k) => {
        const off = (r - data[i]) ** 2 + (g - data[i + 1]) ** 2 + (b - data[i + 2]) ** 2;
        if (off < least) [best, least] = [k, off];
      });
      known.set(key, best);
    }
    return known.get(key);
  };
}

/** Compress numbers of eight bits by GIF's LZW, in blocks of 255 bytes. */
function compressLzw(numbers, out) {
  const bytes = [];
  let [bits, held, size] = [0, 0, 9];
  const put = (code) => {
    bits |= code << held;
    for (held += size; held >= 8; held -= 8) {
      bytes.push(bits & 255);
      bits >>>= 8;
    }
  };
  let codes = new Map();
  let next = 258;
  put(256);
  let last = numbers[0];
  for (let k = 1; k < numbers.length; k += 1) {
    const key = (last << 8) | numbers[k];
    const known = codes.get(key);
    if (known !== undefined) {
      last = known;
      continue;
    }
    put(last);
    if (next < LONGEST_CODE) {
      if (next === 1 << size) size += 1;
      codes.set(key, next);
      next += 1;
    } else {
      put(256);
      codes = new Map();
      [next, size] = [258, 9];
    }
    last = numbers[k];
  }
  put(last);
  if (next === 1 << size && size < 12) size += 1;
  put(257);
  if (held > 0) bytes.push(bits & 255);
  for (let k = 0; k < bytes.length; k += 255) {
    const block = bytes.slice(k, k + 255);
    out.push(block.length, ...block);
  }
  out.push(0);
}

/**
 * Encode a GIF that repeats for ever.
 * @param {Uint8ClampedArray[]} pictures red, green, blue, opacity of each pixel @param {number} delay [s] of each
 * @returns {number[]} its bytes
 */
export function encodeGif(pictures, width, height, delay) {
  const palette = choosePalette(pictures);
  const nearest = makeColourFinder(palette);
  const two = (n) => [n & 255, n >> 8];
  const letters = (text) => [...text].map((letter) => letter.charCodeAt(0));
  const out = [...letters("GIF89a"), ...two(width), ...two(height), 0xf7, 0, 0];
  for (let k = 0; k < 256; k += 1) out.push(...(palette[k] ?? [0, 0, 0]));
  out.push(0x21, 0xff, 11, ...letters("NETSCAPE2.0"), 3, 1, 0, 0, 0);
  let before = null;
  for (const data of pictures) {
    const numbers = new Uint8Array(width * height);
    const whole = new Uint8Array(width * height);
    for (let p = 0; p < numbers.length; p += 1) {
      whole[p] = nearest(data, 4 * p);
      numbers[p] = before && before[p] === whole[p] ? UNCHANGED : whole[p];
    }
    before = whole;
    out.push(0x21, 0xf9, 4, 0x05, ...two(Math.round(100 * delay)), UNCHANGED, 0);
    out.push(0x2c, 0, 0, 0, 0, ...two(width), ...two(height), 0, 8);
    compressLzw(numbers, out);
  }
  out.push(0x3b);
  return out;
}
