/** @file The load of a section on the moving body: across the bar along a series of cuts, an arrow at a single cut. */

import { roundBelow, formatShort, formatNumber } from "./digits.js";
import { points, locatePoint } from "./poses.js";
import { arrow, polyline, ring } from "./strokes.js";
import { plus, times } from "./vectors.js";

const HIGHEST = 0.28; // of the scene's radius: the largest load of the run
/** Along which axis of the section a load is drawn, or at a single cut acts. */
const DRAWN_ALONG = { Q2: "second", M1: "second" };
const ACTS_ALONG = { N: "normal", T: "normal", Q1: "first", M1: "first", Q2: "second", M2: "second" };

/** The largest size of a load over the run and along the section. @param {object} load */
function largest(load) {
  if (load.largest === undefined) {
    load.largest = 0;
    for (const value of load.values) if (Math.abs(value) > load.largest) load.largest = Math.abs(value);
  }
  return load.largest;
}

/** The loads of a frame along a section, SI. @param {object} section @param {object} load @param {number} frame */
export function along(section, load, frame) {
  const n = section.cuts.length;
  return load.values.subarray(frame * n, (frame + 1) * n);
}

/** Pieces of one sign each, with the places between cuts where the load is 0: [[place, value], ...]. */
function piecesOf(cuts, values) {
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
      const zero = [plus(times(last[0], 1 - t), times(cuts[k], t)), 0];
      piece.push(zero);
      end();
      piece.push(zero);
    }
    piece.push([cuts[k], value]);
  }
  end();
  return pieces;
}

/** The diagram along a series of cuts. */
function drawDiagram(pen, view, poses, section, load, frame, colours, metres, labels) {
  const axis = section[DRAWN_ALONG[load.label] ?? "first"];
  const off = view
    .direct(points(poses, section.body, axis))
    .slice(0, 2)
    .map((c) => c * metres);
  for (const [number, piece] of piecesOf(section.cuts, along(section, load, frame)).entries()) {
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
    tops.forEach((top, k) => polyline(pen, [feet[k], top], colour, 0.9));
    pen.globalAlpha = 1;
    polyline(pen, tops, colour, 2.2, positive ? [] : [6, 3]);
    const middle = tops[Math.floor(tops.length / 2)];
    const foot = feet[Math.floor(tops.length / 2)];
    if (Math.hypot(middle[0] - foot[0], middle[1] - foot[1]) > 20) {
      const [x, y] = [(middle[0] + foot[0]) / 2, (middle[1] + foot[1]) / 2];
      labels.set(`sign ${number}`, positive ? "+" : "−", x, y, colour, 0.5, "center");
    }
  }
  polyline(
    pen,
    section.cuts.map((at) => view.project(locatePoint(poses, section.body, at))),
    colours.ink,
    1,
  );
  return off;
}

/** A load with its number and unit. */
function textOf(load, value) {
  return `${load.label} ${formatNumber(value * load.size, load.style)} ${load.unit === "1" ? "" : load.unit}`.trim();
}

/** The largest of a frame, with its number. */
function labelLargest(pen, view, poses, section, load, frame, colours, off, labels) {
  const values = along(section, load, frame);
  let best = -1;
  for (let k = 0; k < values.length; k += 1) {
    if (Math.abs(values[k]) > (best < 0 ? 0 : Math.abs(values[best]))) best = k;
  }
  if (best < 0) return;
  const [x, y] = view.project(locatePoint(poses, section.body, section.cuts[best]));
  const [tx, ty] = [x + values[best] * off[0], y + values[best] * off[1]];
  const colour = values[best] < 0 ? colours.negative : colours.positive;
  ring(pen, tx, ty, 3, colour, colours.panel, 1);
  labels.add(`load ${load.path}`, textOf(load, values[best]), tx, ty, colour, 4);
}

/**
 * A load of a section at a frame.
 * @param {{section: object, load: object, cut: number, size: number, values: boolean, frame: number}} chosen
 */
export function drawLoad(pen, view, poses, chosen, colours, labels) {
  const { section, cut, size, values: hasLabels, frame } = chosen;
  const load = chosen.force;
  const metres = largest(load) > 0 ? (HIGHEST * view.radius * size) / largest(load) : 0;
  const at = locatePoint(poses, section.body, section.cuts[cut] ?? section.cuts[0]);
  const [x, y] = view.project(at);
  if (section.s) {
    const off = drawDiagram(pen, view, poses, section, load, frame, colours, metres, labels);
    if (hasLabels) labelLargest(pen, view, poses, section, load, frame, colours, off, labels);
    ring(pen, x, y, 4.5, "transparent", colours.accent, 2);
    return;
  }
  const value = along(section, load, frame)[0];
  ring(pen, x, y, 4.5, "transparent", colours.accent, 2);
  if (!Number.isFinite(value)) return;
  const axis = points(poses, section.body, section[ACTS_ALONG[load.label] ?? "first"]);
  const [dx, dy, near] = view.direct(times(axis, value * metres));
  const colour = value < 0 ? colours.negative : colours.positive;
  const heads = load.unit.includes("·") ? 2 : 1;
  arrow(pen, [x, y], [x + dx, y + dy], near * view.scale, colour, colours.panel, heads, value < 0 ? [6, 3] : []);
  if (hasLabels) labels.add(`load ${load.path}`, textOf(load, value), x + dx, y + dy, colour, 4);
}

/** How high how much of a load is, in the corner. @param {number} line which from below */
export function drawLoadScale(pen, view, { force: load, size }, colours, line, labels) {
  if (!(largest(load) > 0)) return;
  const pixels = (HIGHEST * view.radius * size * view.scale) / largest(load) / load.size;
  const amount = roundBelow(90 / pixels);
  const [x, y] = [view.width - 14, view.height - 16 - 20 * line];
  const begin = x - amount * pixels;
  polyline(pen, [[begin, y], [x, y]], colours.positive, 2.2);
  for (const end of [begin, x]) polyline(pen, [[end, y - 4], [end, y + 4]], colours.positive, 1.5);
  const unit = load.unit === "1" ? "" : ` ${load.unit}`;
  const text = `${load.label} ${formatShort(amount)}${unit} =`;
  labels.set("scale of the section", text, begin - 8, y, colours.positive, 10, "right");
}
