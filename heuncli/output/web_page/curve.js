/** @file Curves over time or an angle: axes, events and impulses, extremes, and a cursor at the frame that is shown. */

import { peakOf } from "./courses.js";
import { roundBelow, formatShort, formatNumber } from "./digits.js";
import { cleared, polyline, ring } from "./strokes.js";

const MARGIN = { left: 66, right: 14, top: 24, bottom: 46 };
const MOST_WORDS = 8;
/** Names of the colours of the curves, and the dashes that tell them apart without colour. */
export const PENS = [["positive", []], ["negative", [7, 3]], ["force", [2, 2]], ["moment", [9, 3, 2, 3]]];

/** The smallest and largest known value of some curves. @returns {number[]} */
function rangeOf(courses) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of courses.flatMap((course) => [course.low, course.high])) {
    for (const value of values) {
      if (value < low && value > -Infinity) low = value;
      if (value > high && value < Infinity) high = value;
    }
  }
  return low <= high ? [low, high] : [0, 1];
}

/** Where instants and values stand in a panel [pixels]. */
export class Panel {
  constructor(width, height, axis, courses, band) {
    this.left = MARGIN.left;
    this.right = width - MARGIN.right;
    this.top = MARGIN.top;
    this.bottom = height - MARGIN.bottom;
    this.values = axis.values;
    const ends = [axis, band ?? axis].flatMap(({ values }) => [values[0], values[values.length - 1]]);
    this.first = Math.min(...ends);
    this.span = Math.max(...ends) - this.first || 1;
    let [low, high] = rangeOf(band ? [...courses, band] : courses);
    const last = 10 ** -courses[0].style[0]; // what is below the last certain digit is not drawn as a curve
    if (high - low < 20 * last) [low, high] = [low - 10 * last, high + 10 * last];
    const spare = high - low || Math.abs(high) || 1;
    if (low > 0 && low < spare) low = 0;
    if (high < 0 && -high < spare) high = 0;
    this.low = low - (low === 0 ? 0 : 0.1 * spare);
    this.high = high + (high === 0 ? 0 : 0.14 * spare);
    if (this.high === this.low) this.high += 1;
  }

  x(t) {
    return this.left + ((t - this.first) / this.span) * (this.right - this.left);
  }

  y(value) {
    return this.bottom - ((value - this.low) / (this.high - this.low)) * (this.bottom - this.top);
  }

  /** The frame nearest to a place. */
  frame(x) {
    const wanted = this.first + ((x - this.left) / (this.right - this.left)) * this.span;
    const off = (k) => Math.abs(this.values[k] - wanted);
    return this.values.reduce((best, _, k) => (off(k) < off(best) ? k : best), 0);
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
function formatTick(tick, all) {
  const step = all.length > 1 ? all[1] - all[0] : 1;
  const size = Math.max(...all.map(Math.abs));
  if (size >= 1e7 || size < 1e-3) return formatShort(tick);
  return tick.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))).replace("-", "−");
}

/** Axes, with the unit and numbers. */
function drawAxes(pen, panel, axis, unit, colours, labels) {
  const up = ticks(panel.low, panel.high, 5);
  for (const tick of up) {
    const y = panel.y(tick);
    polyline(pen, [[panel.left, y], [panel.right, y]], colours.line, tick === 0 ? 1.6 : 0.7);
    labels.set(`up ${tick}`, formatTick(tick, up), panel.left - 6, y, colours.ink, 8, "right");
  }
  const across = ticks(panel.first, panel.first + panel.span, Math.max(2, Math.floor((panel.right - panel.left) / 80)));
  for (const tick of across) {
    const x = panel.x(tick);
    polyline(pen, [[x, panel.bottom], [x, panel.bottom + 4]], colours.ink, 1);
    labels.set(`across ${tick}`, formatTick(tick, across), x, panel.bottom + 16, colours.ink, 8, "center");
  }
  const { left, right, top, bottom } = panel;
  polyline(pen, [[left, top], [left, bottom], [right, bottom]], colours.ink, 1);
  labels.set("unit", unit === "1" ? "-" : unit, left - 6, 10, colours.ink, 9, "right");
  labels.set("axis", `${axis.label} [${axis.unit}]`, right, bottom + 33, colours.ink, 9, "right");
}

/** One line; where it is open it is broken. */
function drawValues(pen, panel, values, colour, dash, x = panel.values, width = 1.8) {
  let run = [];
  for (let k = 0; k <= values.length; k += 1) {
    if (k < values.length && Number.isFinite(values[k])) {
      run.push([panel.x(x[k]), panel.y(values[k])]);
    } else {
      if (run.length > 1) polyline(pen, run, colour, width, dash);
      run = [];
    }
  }
}

/** What lies between the smallest and the greatest, as a band; where it is open it is broken. */
function drawBand(pen, panel, { low, high }, colour, values = panel.values) {
  const shown = [...low.keys()].filter((k) => Number.isFinite(low[k]));
  pen.globalAlpha = 0.18;
  pen.fillStyle = colour;
  for (let begin = 0, end = 0; begin < shown.length; begin = end) {
    while (end < shown.length && shown[end] - shown[begin] === end - begin) end += 1;
    const known = shown.slice(begin, end);
    pen.beginPath();
    known.forEach((k, i) => pen[i ? "lineTo" : "moveTo"](panel.x(values[k]), panel.y(high[k])));
    known.reverse().forEach((k) => pen.lineTo(panel.x(values[k]), panel.y(low[k])));
    pen.closePath();
    pen.fill();
  }
  pen.globalAlpha = 1;
}

/** The highest or the lowest, with its number and unit. */
function drawPeak(pen, panel, course, highest, colour, colours, labels, rank) {
  const k = peakOf(course, highest);
  if (k < 0) return;
  const value = (highest ? course.high : course.low)[k];
  const [x, y] = [panel.x(panel.values[k]), panel.y(value)];
  ring(pen, x, y, 3, colours.panel, colour, 1.5);
  const text = `${formatNumber(value, course.style)} ${course.unit === "1" ? "" : course.unit}`.trim();
  labels.add(`peak ${course.path} ${highest}`, text, x, y, colours.ink, rank, 7);
}

/** The envelope of all load cases, behind the curves, with its extremes and their cases. */
function drawEnvelope(pen, panel, band, { style, unit, path }, colours, labels) {
  drawBand(pen, panel, band, colours.faint, band.values);
  for (const values of [band.low, band.high]) drawValues(pen, panel, values, colours.faint, [], band.values, 0.8);
  for (const [end, rank] of [[band.greatest, 8], [band.least, 7.5]]) {
    const [x, y] = [panel.x(end.x), panel.y(end.value)];
    ring(pen, x, y, 3, colours.panel, colours.ink, 1.5);
    const value = `${formatNumber(end.value, style)} ${unit === "1" ? "" : unit}`.trim();
    labels.add(`envelope ${path} ${rank}`, `${value}, ${band.names[end.run]}`, x, y, colours.ink, rank, 7);
  }
}

/**
 * The whole picture.
 * @param {HTMLCanvasElement} canvas @param {object} data @param {import("./courses.js").Course[]} courses of one unit
 * @param {{label: string, values: Float64Array}} axis
 * @param {import("./envelope.js").Envelope & {names: string[]}|null} band of the first curve @param {number} frame
 * @param {import("./labels.js").LabelList} labels @returns {Panel}
 */
export function drawCurve(canvas, data, courses, axis, band, frame, colours, labels) {
  const { pen, width, height } = cleared(canvas);
  labels.begin(pen, width, height);
  const panel = new Panel(width, height, axis, courses, band);
  drawAxes(pen, panel, axis, courses[0].unit, colours, labels);
  for (const mark of data.marks) {
    const x = panel.x(axis.values[mark.frame]);
    polyline(pen, [[x, panel.top], [x, panel.bottom]], colours.faint, 1, [3, 3]);
    if (data.marks.length > MOST_WORDS) continue;
    labels.set(`mark ${mark.frame}`, mark.words, x, 10, colours.faint, 2, "center");
  }
  if (band) drawEnvelope(pen, panel, band, courses[0], colours, labels);
  courses.forEach((course, k) => {
    const [name, dash] = PENS[k % PENS.length];
    if (course.low !== course.high) {
      drawBand(pen, panel, course, colours[name]);
      drawValues(pen, panel, course.low, colours[name], dash);
    }
    drawValues(pen, panel, course.high, colours[name], dash);
    if (!course.high.some(Number.isFinite)) {
      const middle = (panel.left + panel.right) / 2;
      labels.set(`open ${k}`, "open at all times", middle, panel.top + 24 + 18 * k, colours.faint, 3, "center");
    }
    if (band && k === 0) return; // the extremes of all cases are marked in place of its own
    drawPeak(pen, panel, course, true, colours[name], colours, labels, 5 - k);
    drawPeak(pen, panel, course, false, colours[name], colours, labels, 4.5 - k);
  });
  const x = panel.x(axis.values[frame]);
  polyline(pen, [[x, panel.top], [x, panel.bottom]], colours.accent, 1.5);
  for (const values of new Set(courses.flatMap((course) => [course.high, course.low]))) {
    if (Number.isFinite(values[frame])) ring(pen, x, panel.y(values[frame]), 4, colours.accent, colours.panel, 1.5);
  }
  labels.write(colours.panel);
  return panel;
}
