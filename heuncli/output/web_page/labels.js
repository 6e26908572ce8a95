/** @file The words on a canvas: gathered, then placed so that none stands on another and none leaves the canvas. */

import { FONT, words } from "./strokes.js";

const SPARE = 4; // pixels: words keep so far from the rim of their canvas
const HIGH = 15; // pixels: of a line of words
const GAP = 3; // pixels between words
const KEEPS = 0.3; // by which rank what was shown last goes before others, so that words do not flicker
/** Where words may stand about their place: which way across, which way down, how far off [pixels]. */
const SLOTS = [
  [1, -1, 1], [1, 1, 1], [-1, -1, 1], [-1, 1, 1], [1, 0, 1], [-1, 0, 1], [0, -1, 1.4], [0, 1, 1.4],
  [1, -1, 2.6], [1, 1, 2.6], [-1, -1, 2.6], [-1, 1, 2.6], [0, -1, 3], [0, 1, 3],
];
const widths = new Map();

/** How wide words are [pixels]. */
function widthOf(pen, text) {
  if (!widths.has(text)) {
    if (widths.size > 4000) widths.clear();
    pen.font = FONT;
    widths.set(text, pen.measureText(text).width);
  }
  return widths.get(text);
}

/** The words of a canvas. */
export class LabelList {
  constructor() {
    /** @type {Map<string, number>} the slot in which the words of a key stood last */
    this.last = new Map();
  }

  /** Begin a picture; of another view nothing is remembered. @param {number} view its number */
  begin(pen, width, height, view = 0) {
    if (view !== this.view) this.last.clear();
    Object.assign(this, { pen, width, height, view, items: [] });
  }

  /** Words that stand about a place. @param {string} key whose they are @param {number} rank the greatest goes first */
  add(key, text, x, y, colour, rank, gap = 8) {
    this.items.push({ key, text, x, y, colour, rank: rank + (this.last.has(key) ? KEEPS : 0), gap, slots: SLOTS });
  }

  /** Words that have one place. @param {number} rank those of 9 and more are there at any rate */
  set(key, text, x, y, colour, rank, align = "left") {
    const across = { left: 1, center: 0, right: -1 }[align];
    this.items.push({ key, text, x, y, colour, rank, gap: 0, slots: [[across, 0, 1]] });
  }

  /** Place and write them. @param {string} paper the colour of the ground */
  write(paper) {
    const placed = [];
    const shown = new Map();
    this.items.sort((a, b) => b.rank - a.rank);
    for (const item of this.items) {
      const wide = widthOf(this.pen, item.text);
      const before = this.last.get(item.key);
      const order = item.slots.map((_, k) => k);
      if (before > 0 && before < order.length) order.unshift(...order.splice(before, 1));
      for (const slot of order) {
        const box = this.boxOf(item, item.slots[slot], wide);
        const free = placed.every((b) => box[0] >= b[2] || box[2] <= b[0] || box[1] >= b[3] || box[3] <= b[1]);
        if (!free) continue;
        placed.push(box);
        shown.set(item.key, slot);
        words(this.pen, item.text, box[0] + GAP, (box[1] + box[3]) / 2, item.colour, paper);
        break;
      }
    }
    this.last = shown;
  }

  /** The box of words in a slot, moved onto the canvas: left, top, right, bottom. */
  boxOf({ x, y, gap }, [across, down, far], wide) {
    const off = gap * far;
    const left = x + across * off - (wide * (1 - across)) / 2;
    const top = y + down * (off + (across ? 0 : HIGH / 2)) - HIGH / 2;
    const a = Math.max(SPARE, Math.min(left, this.width - SPARE - wide)) - GAP;
    const b = Math.max(SPARE, Math.min(top, this.height - SPARE - HIGH));
    return [a, b, a + wide + 2 * GAP, b + HIGH];
  }
}
