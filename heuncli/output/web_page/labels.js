/** @file Labels of a canvas: collected, then placed by rank so that none overlaps another or leaves the canvas. */

import { FONT, drawText } from "./strokes.js";

const MARGIN_TO_RIM = 4; // pixels: words keep so far from the rim of their canvas
const LINE_HEIGHT = 15; // pixels: of a line of words
const LABEL_GAP = 3; // pixels between words
const STICKINESS = 0.3; // by which rank what was shown last goes before others, so that words do not flicker
/** The positions of a label about its point: side across, side down, multiple of the gap. */
const SLOTS = [
  [1, -1, 1], [1, 1, 1], [-1, -1, 1], [-1, 1, 1], [1, 0, 1], [-1, 0, 1], [0, -1, 1.4], [0, 1, 1.4],
  [1, -1, 2.6], [1, 1, 2.6], [-1, -1, 2.6], [-1, 1, 2.6], [0, -1, 3], [0, 1, 3],
];
const widths = new Map();

/** Measure the width of a text [pixels]; remembered, because measuring is slow. */
function measureWidth(pen, text) {
  if (!widths.has(text)) {
    if (widths.size > 4000) widths.clear();
    pen.font = FONT;
    widths.set(text, pen.measureText(text).width);
  }
  return widths.get(text);
}

/** The labels of one canvas. */
export class LabelList {
  constructor() {
    /** @type {Map<string, number>} the slot in which the words of a key stood last */
    this.last = new Map();
  }

  /** Begin a picture. @param {number} view its number; a new view forgets where labels stood */
  begin(pen, width, height, view = 0) {
    if (view !== this.view) this.last.clear();
    Object.assign(this, { pen, width, height, view, items: [] });
  }

  /**
   * Add a label beside a point.
   * @param {string} key of what it names @param {number} rank the greatest is placed first
   */
  add(key, text, x, y, colour, rank, gap = 8) {
    this.items.push({ key, text, x, y, colour, rank: rank + (this.last.has(key) ? STICKINESS : 0), gap, slots: SLOTS });
  }

  /** Add a label with one possible position, which is left out if that is taken. */
  addFixed(key, text, x, y, colour, rank, align = "left") {
    const across = { left: 1, center: 0, right: -1 }[align];
    this.items.push({ key, text, x, y, colour, rank, gap: 0, slots: [[across, 0, 1]] });
  }

  /** Place and draw all labels; one that finds no room is left out. @param {string} paper background colour */
  write(paper) {
    const placed = [];
    const shown = new Map();
    this.items.sort((a, b) => b.rank - a.rank);
    for (const item of this.items) {
      const textWidth = measureWidth(this.pen, item.text);
      const before = this.last.get(item.key);
      const slotOrder = item.slots.map((_, k) => k);
      if (before > 0 && before < slotOrder.length) slotOrder.unshift(...slotOrder.splice(before, 1));
      for (const slot of slotOrder) {
        const box = this.findBox(item, item.slots[slot], textWidth);
        const free = placed.every((b) => box[0] >= b[2] || box[2] <= b[0] || box[1] >= b[3] || box[3] <= b[1]);
        if (!free) continue;
        placed.push(box);
        shown.set(item.key, slot);
        drawText(this.pen, item.text, box[0] + LABEL_GAP, (box[1] + box[3]) / 2, item.colour, paper);
        break;
      }
    }
    this.last = shown;
  }

  /** Find the box of a text in a slot, moved onto the canvas: left, top, right, bottom. */
  findBox({ x, y, gap }, [across, down, far], textWidth) {
    const off = gap * far;
    const left = x + across * off - (textWidth * (1 - across)) / 2;
    const top = y + down * (off + (across ? 0 : LINE_HEIGHT / 2)) - LINE_HEIGHT / 2;
    const a = Math.max(MARGIN_TO_RIM, Math.min(left, this.width - MARGIN_TO_RIM - textWidth)) - LABEL_GAP;
    const b = Math.max(MARGIN_TO_RIM, Math.min(top, this.height - MARGIN_TO_RIM - LINE_HEIGHT));
    return [a, b, a + textWidth + 2 * LABEL_GAP, b + LINE_HEIGHT];
  }
}
