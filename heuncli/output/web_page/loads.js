/** @file Draws a section load on the moving body: a diagram across the bar, or an arrow at a single cut. */

import { rememberByObject } from "./data.js";
import { formatShort, formatUnit, formatWithUnit, roundBelow } from "./digits.js";
import { add, locatePoint, rotateDirection, scale } from "./poses.js";
import { drawArrow, drawPolyline, drawRing } from "./strokes.js";

const HIGHEST = 0.28; // of the scene's radius: the largest load of the run
/** The axis of the section along which a load is plotted, and the one along which it acts. */
const DRAWN_ALONG = { Q2: "second", M1: "second", w2: "second", slope2: "second" };
const ACTS_ALONG = { N: "normal", T: "normal", Q1: "first", M1: "first", Q2: "second", M2: "second" };

/** Find the largest magnitude of a load over the run and along the section. @param {SectionLoad} load */
const findLargest = rememberByObject((load) => {
  let largest = 0;
  for (const value of load.values) if (Math.abs(value) > largest) largest = Math.abs(value);
  return largest;
});

/**
 * Get the loads of a frame along a section, SI, as a view of the stored array.
 * @param {PageSection} section @param {object} load @param {number} frame
 */
export function getLoadsAlong(section, load, frame) {
  const n = section.cuts.length;
  return load.values.subarray(frame * n, (frame + 1) * n);
}

/** Split a diagram into pieces of one sign, each [[point, value], ...]; zeros between cuts are interpolated. */
function splitBySign(cuts, values) {
  const pieces = [];
  let piece = [];
  const end = () => {
    if (piece.length > 1) pieces.push(piece);
    piece = [];
  };
  for (let k = 0; k < cuts.length; k += 1) {
    const value = values[k];
    if (Number.isNaN(value)) {
      end();
      continue;
    }
    const last = piece[piece.length - 1];
    if (last && last[1] * value < 0) {
      const t = last[1] / (last[1] - value);
      const zero = [add(scale(last[0], 1 - t), scale(cuts[k], t)), 0];
      piece.push(zero);
      end();
      piece.push(zero);
    }
    piece.push([cuts[k], value]);
  }
  end();
  return pieces;
}

/** Draw the diagram along a run of cuts. @returns {number[]} pixels right and down for one SI unit */
function drawDiagram(pen, view, poses, section, load, frame, colours, metres, labels) {
  const axis = section[DRAWN_ALONG[load.label] ?? "first"];
  const off = view
    .projectVector(rotateDirection(poses, section.body, axis))
    .slice(0, 2)
    .map((c) => c * metres);
  for (const [number, piece] of splitBySign(section.cuts, getLoadsAlong(section, load, frame)).entries()) {
    const positive = piece.reduce((sum, [, value]) => sum + value, 0) >= 0;
    const colour = positive ? colours.positive : colours.negative;
    const feet = piece.map(([at]) => view.project(locatePoint(poses, section.body, at)).slice(0, 2));
    const tops = piece.map(([, value], k) => [feet[k][0] + value * off[0], feet[k][1] + value * off[1]]);
    pen.beginPath();
    [...feet, ...[...tops].reverse()].forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.closePath();
    pen.globalAlpha = 0.22;
    pen.fillStyle = colour;
    pen.fill();
    pen.globalAlpha = 0.65;
    tops.forEach((top, k) => drawPolyline(pen, [feet[k], top], colour, 0.9));
    pen.globalAlpha = 1;
    drawPolyline(pen, tops, colour, 2.2, positive ? [] : [6, 3]);
    const middle = tops[Math.floor(tops.length / 2)];
    const foot = feet[Math.floor(tops.length / 2)];
    if (Math.hypot(middle[0] - foot[0], middle[1] - foot[1]) > 20) {
      const [x, y] = [(middle[0] + foot[0]) / 2, (middle[1] + foot[1]) / 2];
      labels.addFixed(`sign ${number}`, positive ? "+" : "−", x, y, colour, 0.5, "center");
    }
  }
  drawPolyline(
    pen,
    section.cuts.map((at) => view.project(locatePoint(poses, section.body, at))),
    colours.ink,
    1,
  );
  return off;
}

/** Format a load with its label, number and unit. */
function formatLoad(load, value) {
  return `${load.label} ${formatWithUnit(value * load.size, load.style, load.unit)}`;
}

/** Mark the largest value of a frame with its number. */
function labelLargest(pen, view, poses, section, load, frame, colours, off, labels) {
  const values = getLoadsAlong(section, load, frame);
  let best = -1;
  for (let k = 0; k < values.length; k += 1) {
    if (Math.abs(values[k]) > (best < 0 ? 0 : Math.abs(values[best]))) best = k;
  }
  if (best < 0) return;
  const [x, y] = view.project(locatePoint(poses, section.body, section.cuts[best]));
  const [tx, ty] = [x + values[best] * off[0], y + values[best] * off[1]];
  const colour = values[best] < 0 ? colours.negative : colours.positive;
  drawRing(pen, tx, ty, 3, colour, colours.panel, 1);
  labels.add(`load ${load.path}`, formatLoad(load, values[best]), tx, ty, colour, 4);
}

/**
 * Draw a load of a section at a frame.
 * @param {{section: object, load: object, cut: number, size: number, values: boolean, frame: number}} options
 */
export function drawLoad(pen, view, poses, options, colours, labels) {
  const { section, cut, size, values: hasLabels, frame } = options;
  const load = options.force;
  const metres = findLargest(load) > 0 ? (HIGHEST * view.radius * size) / findLargest(load) : 0;
  const at = locatePoint(poses, section.body, section.cuts[cut] ?? section.cuts[0]);
  const [x, y] = view.project(at);
  if (section.s) {
    const off = drawDiagram(pen, view, poses, section, load, frame, colours, metres, labels);
    if (hasLabels) labelLargest(pen, view, poses, section, load, frame, colours, off, labels);
    drawRing(pen, x, y, 4.5, "transparent", colours.accent, 2);
    return;
  }
  const value = getLoadsAlong(section, load, frame)[0];
  drawRing(pen, x, y, 4.5, "transparent", colours.accent, 2);
  if (!Number.isFinite(value)) return;
  const axis = rotateDirection(poses, section.body, section[ACTS_ALONG[load.label] ?? "first"]);
  const [dx, dy, near] = view.projectVector(scale(axis, value * metres));
  const colour = value < 0 ? colours.negative : colours.positive;
  const heads = load.unit.includes("·") ? 2 : 1;
  drawArrow(pen, [x, y], [x + dx, y + dy], near * view.scale, colour, colours.panel, heads, value < 0 ? [6, 3] : []);
  labels.avoid([x, y], [x + dx, y + dy]);
  if (hasLabels) labels.add(`load ${load.path}`, formatLoad(load, value), x + dx, y + dy, colour, 4);
}

/** Draw the scale of the diagram in the corner. @param {number} line its place, counted from below */
export function drawLoadScale(pen, view, { force: load, size }, colours, line, labels) {
  if (!(findLargest(load) > 0)) return;
  const pixels = (HIGHEST * view.radius * size * view.scale) / findLargest(load) / load.size;
  const amount = roundBelow(90 / pixels);
  const [x, y] = [view.width - 14, view.height - 16 - 20 * line];
  const begin = x - amount * pixels;
  drawPolyline(pen, [[begin, y], [x, y]], colours.positive, 2.2);
  for (const end of [begin, x]) drawPolyline(pen, [[end, y - 4], [end, y + 4]], colours.positive, 1.5);
  const text = `${load.label} ${formatShort(amount)} ${formatUnit(load.unit)}`.trimEnd() + " =";
  labels.addFixed("scale of the section", text, begin - 8, y, colours.positive, 10, "right");
}
