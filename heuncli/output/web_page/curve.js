/** @file A curve over time: axes, events and blows, extremes, and a cursor at the frame that is shown. */

import { cleared } from "./canvases.js";
import { peakOf } from "./courses.js";
import { roundBelow, short, written } from "./digits.js";
import { polyline, ring, words } from "./strokes.js";

const MARGIN = { left: 62, right: 14, top: 20, bottom: 34 };
const MOST_WORDS = 8;

/** Where instants and values stand in a panel [pixels]. */
export class Panel {
  constructor(width, height, time, course) {
    this.left = MARGIN.left;
    this.right = width - MARGIN.right;
    this.top = MARGIN.top;
    this.bottom = height - MARGIN.bottom;
    this.first = time[0];
    this.span = time[time.length - 1] - time[0] || 1;
    const known = [...course.low, ...course.high].filter(Number.isFinite);
    let [low, high] = known.length ? [Math.min(...known), Math.max(...known)] : [0, 1];
    const last = 10 ** -course.style[0]; // what is below the last certain digit is not drawn as if it were something
    if (high - low < 20 * last) [low, high] = [low - 10 * last, high + 10 * last];
    const spare = high - low || Math.abs(high) || 1;
    if (low > 0 && low < spare) low = 0;
    if (high < 0 && -high < spare) high = 0;
    this.low = low - (low === 0 ? 0 : 0.08 * spare);
    this.high = high + (high === 0 ? 0 : 0.12 * spare);
    if (this.high === this.low) this.high += 1;
  }

  x(t) {
    return this.left + ((t - this.first) / this.span) * (this.right - this.left);
  }

  y(value) {
    return this.bottom - ((value - this.low) / (this.high - this.low)) * (this.bottom - this.top);
  }

  /** The instant under a place [s]. */
  instant(x) {
    return this.first + ((x - this.left) / (this.right - this.left)) * this.span;
  }
}

/** Round numbers between two, with a step that leaves so many at most. */
function ticks(low, high, most) {
  let step = roundBelow((high - low) / most);
  while ((high - low) / step > most) step *= 2;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) found.push(k * step);
  return found.map((tick) => Number(tick.toPrecision(12)));
}

/** A number of an axis. @param {number} tick @param {number[]} all its neighbours, whose digits it needs, too */
function told(tick, all) {
  const step = all.length > 1 ? all[1] - all[0] : 1;
  const size = Math.max(...all.map(Math.abs));
  if (size >= 1e7 || size < 1e-3) return short(tick);
  return tick.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))).replace("-", "−");
}

/** Axes, with the unit and numbers. */
function drawAxes(pen, panel, course, colours) {
  const up = ticks(panel.low, panel.high, 5);
  for (const tick of up) {
    const y = panel.y(tick);
    polyline(
      pen,
      [
        [panel.left, y],
        [panel.right, y],
      ],
      colours.line,
      tick === 0 ? 1.6 : 0.7,
    );
    words(pen, told(tick, up), panel.left - 6, y, colours.ink, colours.panel, "right");
  }
  const across = ticks(panel.first, panel.first + panel.span, Math.max(2, Math.floor((panel.right - panel.left) / 80)));
  for (const tick of across) {
    const x = panel.x(tick);
    polyline(
      pen,
      [
        [x, panel.bottom],
        [x, panel.bottom + 4],
      ],
      colours.ink,
      1,
    );
    words(pen, told(tick, across), x, panel.bottom + 13, colours.ink, colours.panel, "center");
  }
  polyline(
    pen,
    [
      [panel.left, panel.top],
      [panel.left, panel.bottom],
      [panel.right, panel.bottom],
    ],
    colours.ink,
    1,
  );
  words(pen, `[${course.unit === "1" ? "-" : course.unit}]`, panel.left - 6, 9, colours.ink, colours.panel, "right");
  words(pen, "t [s]", panel.right, panel.bottom + 26, colours.ink, colours.panel, "right");
}

/** One line over time; where it is open it is broken. */
function drawValues(pen, panel, time, values, colour, dash) {
  let run = [];
  for (let k = 0; k <= values.length; k += 1) {
    if (k < values.length && Number.isFinite(values[k])) {
      run.push([panel.x(time[k]), panel.y(values[k])]);
    } else {
      if (run.length > 1) polyline(pen, run, colour, 1.8, dash);
      run = [];
    }
  }
}

/** The highest or the lowest, with its number. */
function drawPeak(pen, panel, time, course, highest, colours) {
  const k = peakOf(course, highest);
  if (k < 0) return;
  const value = (highest ? course.high : course.low)[k];
  const [x, y] = [panel.x(time[k]), panel.y(value)];
  ring(pen, x, y, 3, colours.panel, colours.positive, 1.5);
  const right = x > (panel.left + panel.right) / 2;
  words(
    pen,
    written(value, course.style),
    x + (right ? -6 : 6),
    y + (highest || y > panel.bottom - 16 ? -9 : 9),
    colours.ink,
    colours.panel,
    right ? "right" : "left",
  );
}

/**
 * The whole picture.
 * @param {HTMLCanvasElement} canvas @param {object} data @param {import("./courses.js").Course} course
 * @param {number} frame @returns {Panel}
 */
export function drawCurve(canvas, data, course, frame, colours) {
  const { pen, width, height } = cleared(canvas);
  const { time, marks } = data;
  const panel = new Panel(width, height, time, course);
  drawAxes(pen, panel, course, colours);
  for (const mark of marks) {
    const x = panel.x(mark.time);
    polyline(
      pen,
      [
        [x, panel.top],
        [x, panel.bottom],
      ],
      colours.faint,
      1,
      [3, 3],
    );
    if (marks.length <= MOST_WORDS) words(pen, mark.words, x, panel.top - 9, colours.faint, colours.panel, "center");
  }
  drawValues(pen, panel, time, course.high, colours.positive, []);
  if (course.low !== course.high) drawValues(pen, panel, time, course.low, colours.negative, [6, 3]);
  if (!course.high.some(Number.isFinite)) {
    words(
      pen,
      "open at all times",
      (panel.left + panel.right) / 2,
      panel.top + 24,
      colours.faint,
      colours.panel,
      "center",
    );
  }
  drawPeak(pen, panel, time, course, true, colours);
  drawPeak(pen, panel, time, course, false, colours);
  const x = panel.x(time[frame]);
  polyline(
    pen,
    [
      [x, panel.top],
      [x, panel.bottom],
    ],
    colours.accent,
    1.5,
  );
  for (const values of new Set([course.high, course.low])) {
    if (Number.isFinite(values[frame])) ring(pen, x, panel.y(values[frame]), 4, colours.accent, colours.panel, 1.5);
  }
  return panel;
}
