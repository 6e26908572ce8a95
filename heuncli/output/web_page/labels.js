/** @file Labels of a canvas: collected, then placed by rank so that none overlaps another or leaves the canvas, nor
 * lies over an arrow if there is another place. */

import { drawText, FONT } from "./strokes.js";

const MARGIN_TO_RIM = 4; // pixels: words keep so far from the rim of their canvas
const LINE_HEIGHT = 15; // pixels: of a line of words
const MIN_ALIGNMENT = 0.6; // cosine: a slot nearer to a direction lies along it
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

/** The cosine between a direction of unit length and that of a slot. */
function alignSlot([across, down], direction) {
  return (across * direction[0] + down * direction[1]) / Math.hypot(across, down);
}

/** Order the slots of a label: the last one first unless a direction has turned away from it, then those along it. */
function orderSlots({ slots, direction }, last) {
  const order = slots.map((_, k) => k);
  const isAlong = (k) => !direction || alignSlot(slots[k], direction) > MIN_ALIGNMENT;
  order.sort((a, b) => Number(isAlong(b)) - Number(isAlong(a)));
  const place = order.indexOf(last);
  if (place > 0 && isAlong(last)) order.unshift(...order.splice(place, 1));
  return order;
}

/** A box of a label: left, top, right, bottom [pixels]. @typedef {[number, number, number, number]} Box */

/** Whether two boxes overlap. @param {Box} a @param {Box} b */
function isOverlapping(a, b) {
  return a[0] < b[2] && a[2] > b[0] && a[1] < b[3] && a[3] > b[1];
}

/** Whether a line from one point to another passes through a box. @param {Box} box */
function isCrossing([from, to], box) {
  let [first, last] = [0, 1]; // the part of the line that is within the sides looked at so far
  for (const i of [0, 1]) {
    const step = to[i] - from[i];
    const ends = [box[i] - from[i], box[i + 2] - from[i]];
    if (step === 0 && (ends[0] > 0 || ends[1] < 0)) return false;
    if (step === 0) continue;
    const shares = ends.map((end) => end / step);
    first = Math.max(first, Math.min(...shares));
    last = Math.min(last, Math.max(...shares));
  }
  return first < last;
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
    Object.assign(this, { pen, width, height, view, items: [], arrows: [] });
  }

  /**
   * Add a label beside a point.
   * @param {string} key of what it names @param {number} rank the greatest is placed first
   * @param {number[]} [direction] of unit length, in which the label should stand: beyond an arrow's tip, beside a bar
   */
  add(key, text, x, y, colour, rank, gap = 8, direction = null) {
    const stickiness = this.last.has(key) ? STICKINESS : 0;
    this.items.push({ key, text, x, y, colour, rank: rank + stickiness, gap, slots: SLOTS, direction });
  }

  /** Keep labels off an arrow, as far as they find another place. @param {number[]} from @param {number[]} to */
  avoid(from, to) {
    this.arrows.push([from, to]);
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
      const free = orderSlots(item, this.last.get(item.key))
        .map((slot) => ({ slot, box: this.findBox(item, item.slots[slot], textWidth) }))
        .filter(({ box }) => !placed.some((other) => isOverlapping(box, other)));
      const chosen = free.find(({ box }) => !this.arrows.some((arrow) => isCrossing(arrow, box))) ?? free[0];
      if (!chosen) continue;
      const { slot, box } = chosen;
      placed.push(box);
      shown.set(item.key, slot);
      drawText(this.pen, item.text, box[0] + LABEL_GAP, (box[1] + box[3]) / 2, item.colour, paper);
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
