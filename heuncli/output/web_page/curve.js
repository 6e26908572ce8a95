/** @file Draws curves over time or an angle: axes, events, extremes, and a cursor at the frame that is shown; and the
 * controls that choose the curves. */

import { listenToCheckBox } from "./controls.js";
import { formatShort, formatWithUnit, roundBelow } from "./digits.js";
import { fillSelect, findElement, makeElement } from "./elements.js";
import { findPeakFrame } from "./histories.js";
import { clearCanvas, drawPolyline, drawRing } from "./strokes.js";

const MARGIN = { left: 66, right: 14, top: 24, bottom: 46 };
const MAX_NAMED_MARKS = 8;
/** The colour name and the dash of each curve; the dash tells curves apart in black and white. */
export const PENS = [["positive", []], ["negative", [7, 3]], ["force", [2, 2]], ["moment", [9, 3, 2, 3]]];

/** Find the smallest and the largest finite value of some curves; [0, 1] if there is none. @returns {number[]} */
function findRange(histories) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of histories.flatMap((history) => [history.low, history.high])) {
    for (const value of values) {
      if (value < low && value > -Infinity) low = value;
      if (value > high && value < Infinity) high = value;
    }
  }
  return low <= high ? [low, high] : [0, 1];
}

/** The plot area: maps the axis and the values to pixels and back. */
export class Panel {
  constructor(width, height, axis, histories, envelope) {
    this.left = MARGIN.left;
    this.right = width - MARGIN.right;
    this.top = MARGIN.top;
    this.bottom = height - MARGIN.bottom;
    this.values = axis.values;
    const ends = [axis, envelope ?? axis].flatMap(({ values }) => [values[0], values[values.length - 1]]);
    this.first = Math.min(...ends);
    this.span = Math.max(...ends) - this.first || 1;
    let [low, high] = findRange(envelope ? [...histories, envelope] : histories);
    const last = 10 ** -histories[0].style[0]; // what is below the last certain digit is not drawn as a curve
    if (high - low < 20 * last) [low, high] = [low - 10 * last, high + 10 * last];
    const extent = high - low || Math.abs(high) || 1;
    if (low > 0 && low < extent) low = 0;
    if (high < 0 && -high < extent) high = 0;
    this.low = low - (low === 0 ? 0 : 0.1 * extent);
    this.high = high + (high === 0 ? 0 : 0.14 * extent);
    if (this.high === this.low) this.high += 1;
  }

  x(t) {
    return this.left + ((t - this.first) / this.span) * (this.right - this.left);
  }

  y(value) {
    return this.bottom - ((value - this.low) / (this.high - this.low)) * (this.bottom - this.top);
  }

  /** Find the frame nearest to a point of the screen [pixels]. */
  findFrame(x) {
    const wanted = this.first + ((x - this.left) / (this.right - this.left)) * this.span;
    const distance = (k) => Math.abs(this.values[k] - wanted);
    return this.values.reduce((best, _, k) => (distance(k) < distance(best) ? k : best), 0);
  }
}

/** Make round numbers between two limits, at most so many steps. */
function makeTicks(low, high, maxSteps) {
  let step = roundBelow((high - low) / maxSteps);
  while ((high - low) / step > maxSteps) step *= 2;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) found.push(k * step);
  return found.map((tick) => Number(tick.toPrecision(12)));
}

/** Format a number of an axis. @param {number} tick @param {number[]} all of the axis, which have equal decimals */
function formatTick(tick, all) {
  const step = all.length > 1 ? all[1] - all[0] : 1;
  const size = Math.max(...all.map(Math.abs));
  if (size >= 1e7 || size < 1e-3) return formatShort(tick);
  return tick.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))).replace("-", "−");
}

/** Draw the axes with their numbers and units. */
function drawAxes(pen, panel, axis, unit, colours, labels) {
  const up = makeTicks(panel.low, panel.high, 5);
  for (const tick of up) {
    const y = panel.y(tick);
    drawPolyline(pen, [[panel.left, y], [panel.right, y]], colours.line, tick === 0 ? 1.6 : 0.7);
    labels.addFixed(`up ${tick}`, formatTick(tick, up), panel.left - 6, y, colours.ink, 8, "right");
  }
  const maxSteps = Math.max(2, Math.floor((panel.right - panel.left) / 80)); // 80 pixels hold the longest number
  const across = makeTicks(panel.first, panel.first + panel.span, maxSteps);
  for (const tick of across) {
    const x = panel.x(tick);
    drawPolyline(pen, [[x, panel.bottom], [x, panel.bottom + 4]], colours.ink, 1);
    labels.addFixed(`across ${tick}`, formatTick(tick, across), x, panel.bottom + 16, colours.ink, 8, "center");
  }
  const { left, right, top, bottom } = panel;
  drawPolyline(pen, [[left, top], [left, bottom], [right, bottom]], colours.ink, 1);
  labels.addFixed("unit", unit === "1" ? "-" : unit, left - 6, 10, colours.ink, 9, "right");
  labels.addFixed("axis", `${axis.label} [${axis.unit}]`, right, bottom + 33, colours.ink, 9, "right");
}

/** Draw one curve, with a gap wherever a value is open. */
function drawValues(pen, panel, values, colour, dash, x = panel.values, width = 1.8) {
  let run = [];
  for (let k = 0; k <= values.length; k += 1) {
    if (k < values.length && Number.isFinite(values[k])) {
      run.push([panel.x(x[k]), panel.y(values[k])]);
    } else {
      if (run.length > 1) drawPolyline(pen, run, colour, width, dash);
      run = [];
    }
  }
}

/** Fill the envelope between the smallest and the greatest value, with a gap wherever a value is open. */
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

/** Mark the highest or the lowest value with its number and unit. */
function drawPeak(pen, panel, history, highest, colour, colours, labels, rank) {
  const k = findPeakFrame(history, highest);
  if (k < 0) return;
  const value = (highest ? history.high : history.low)[k];
  const [x, y] = [panel.x(panel.values[k]), panel.y(value)];
  drawRing(pen, x, y, 3, colours.panel, colour, 1.5);
  const text = formatWithUnit(value, history.style, history.unit);
  labels.add(`peak ${history.path} ${highest}`, text, x, y, colours.ink, rank, 7);
}

/** Draw the envelope of all load cases behind the curves, with its extremes and the cases that have them. */
function drawEnvelope(pen, panel, envelope, { style, unit, path }, colours, labels) {
  drawBand(pen, panel, envelope, colours.faint, envelope.values);
  for (const side of [envelope.low, envelope.high]) {
    drawValues(pen, panel, side, colours.faint, [], envelope.values, 0.8);
  }
  for (const [end, rank] of [[envelope.greatest, 8], [envelope.least, 7.5]]) {
    const [x, y] = [panel.x(end.x), panel.y(end.value)];
    drawRing(pen, x, y, 3, colours.panel, colours.ink, 1.5);
    const value = formatWithUnit(end.value, style, unit);
    labels.add(`envelope ${path} ${rank}`, `${value}, ${envelope.names[end.run]}`, x, y, colours.ink, rank, 7);
  }
}

/**
 * Draw the curves and return their plot area.
 * @param {HTMLCanvasElement} canvas @param {CaseData} data
 * @param {TimeHistory[]} histories of one unit
 * @param {{label: string, values: Float64Array}} axis
 * @param {Envelope & {names: string[]}|null} envelope of the first curve @param {number} frame
 * @param {LabelList} labels @returns {Panel}
 */
export function drawCurve(canvas, data, histories, axis, envelope, frame, colours, labels) {
  const { pen, width, height } = clearCanvas(canvas);
  labels.begin(pen, width, height);
  const panel = new Panel(width, height, axis, histories, envelope);
  drawAxes(pen, panel, axis, histories[0].unit, colours, labels);
  for (const mark of data.marks) {
    const x = panel.x(axis.values[mark.frame]);
    drawPolyline(pen, [[x, panel.top], [x, panel.bottom]], colours.faint, 1, [3, 3]);
    if (data.marks.length > MAX_NAMED_MARKS) continue;
    labels.addFixed(`mark ${mark.frame}`, mark.words, x, 10, colours.faint, 2, "center");
  }
  if (envelope) drawEnvelope(pen, panel, envelope, histories[0], colours, labels);
  histories.forEach((history, k) => {
    const [name, dash] = PENS[k % PENS.length];
    if (history.low !== history.high) {
      drawBand(pen, panel, history, colours[name]);
      drawValues(pen, panel, history.low, colours[name], dash);
    }
    drawValues(pen, panel, history.high, colours[name], dash);
    if (!history.high.some(Number.isFinite)) {
      const middle = (panel.left + panel.right) / 2;
      labels.addFixed(`open ${k}`, "open at all times", middle, panel.top + 24 + 18 * k, colours.faint, 3, "center");
    }
    if (envelope && k === 0) return; // the extremes of all cases are marked in place of its own
    drawPeak(pen, panel, history, true, colours[name], colours, labels, 5 - k);
    drawPeak(pen, panel, history, false, colours[name], colours, labels, 4.5 - k);
  });
  const x = panel.x(axis.values[frame]);
  drawPolyline(pen, [[x, panel.top], [x, panel.bottom]], colours.accent, 1.5);
  for (const values of new Set(histories.flatMap((history) => [history.high, history.low]))) {
    if (Number.isFinite(values[frame])) drawRing(pen, x, panel.y(values[frame]), 4, colours.accent, colours.panel, 1.5);
  }
  labels.write(colours.panel);
  return panel;
}

/**
 * Let the user choose curves; a click into the plot goes to the frame there.
 * @param {() => Panel|null} panel
 */
export function listenToCurve(selection, player, redraw, panel) {
  const select = findElement("path");
  fillSelect(select, selection.histories.map((history) => [history.path, history.label]));
  const showAddable = () => {
    const addable = selection.addableHistories.map((history) => [history.path, history.label]);
    fillSelect(findElement("more"), [["", "…"], ...addable]);
    findElement("more").disabled = !addable.length || selection.curves.length >= PENS.length;
    const chips = selection.curves.slice(1).map((path, k) => {
      const { label } = selection.histories.find((history) => history.path === path);
      const chip = makeElement("button", `${label} ×`, { type: "button", class: "chip" });
      chip.style.borderLeftColor = `var(--${PENS[(k + 1) % PENS.length][0]})`;
      chip.addEventListener("click", () => {
        selection.curves = selection.curves.filter((other) => other !== path);
        showAddable();
      });
      return chip;
    });
    findElement("added").replaceChildren(...chips);
    redraw();
  };
  const showFirst = () => {
    if (selection.curves.length) select.value = selection.curves[0];
    showAddable();
  };
  const show = (path) => {
    selection.showHistory(path);
    showFirst();
  };
  select.addEventListener("change", () => show(select.value));
  findElement("more").addEventListener("change", () => {
    if (findElement("more").value) selection.curves.push(findElement("more").value);
    showAddable();
  });
  fillSelect(findElement("across"), selection.axes.map((axis, k) => [String(k), axis.label]));
  findElement("across").value = String(selection.axes.indexOf(selection.axis));
  findElement("acrosslabel").hidden = selection.axes.length < 2;
  findElement("across").addEventListener("change", () => {
    selection.axis = selection.axes[Number(findElement("across").value)];
    redraw();
  });
  const goToPeak = (highest) => () => player.halt(Math.max(0, findPeakFrame(selection.shownHistories[0], highest)));
  findElement("lowest").addEventListener("click", goToPeak(false));
  findElement("highest").addEventListener("click", goToPeak(true));
  const canvas = findElement("curve");
  const goToPointer = (event) => {
    if (event.buttons && panel()) player.halt(panel().findFrame(event.offsetX));
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    goToPointer(event);
  });
  canvas.addEventListener("pointermove", goToPointer);
  if (!selection.curves.length) selection.showHistory(selection.findLargestHistory());
  showFirst();
  if (!selection.histories.length) findElement("over").hidden = true;
  return show;
}

/** Let the user show the envelope of all load cases. @param {boolean} hasCases whether there are several */
export function listenToEnvelope(selection, redraw, hasCases) {
  findElement("bandlabel").hidden = !hasCases;
  listenToCheckBox("band", selection, "hasEnvelope", redraw);
}
