/** @file Draws a chosen set of arrows: forces to one scale, moments to another, each with its number. */

import { getLargest, isMoment, readVector } from "./arrow_choices.js";
import { roundBelow, formatShort, formatNumber } from "./digits.js";
import { drawArrow, drawPolyline } from "./strokes.js";
import { norm } from "./vectors.js";

const MAX_LENGTH = 0.3; // of the scene's radius: the longest arrow of the run
const MIN_NUMBERED = 4e-3; // of the longest arrow: a shorter one has no number
const MIN_RANK = 1.5; // of a number among the labels: that of the shortest arrow
const MAX_RANK = 3; // that of the longest
const LABEL_GAP = 8; // pixels between a tip and its number
const SCALE_LENGTH = 90; // pixels: no scale bar in the corner is longer

/** The length of one SI unit [m], for forces (key false) and for moments (key true). */
function computeScales(choice, view, size) {
  const largest = new Map();
  for (const { row } of choice.rows) {
    largest.set(isMoment(row), Math.max(largest.get(isMoment(row)) ?? 0, getLargest(row)));
  }
  const length = MAX_LENGTH * view.radius * size;
  return new Map([...largest].map(([kind, value]) => [kind, value > 0 ? length / value : 0]));
}

/** The direction of an arrow on the screen, of unit length; null for one that points at the viewer. */
function findDirection(dx, dy) {
  const length = Math.hypot(dx, dy);
  return length > 1 ? [dx / length, dy / length] : null;
}

const chooseColour = (row, colours) => (isMoment(row) ? colours.moment : colours.force);

/** Draw the arrows of a frame. @param {object} options the chosen set, its size, the frame, whether numbers stand by */
export function drawArrows(pen, view, poses, options, colours, labels) {
  const { choice, frame, size, values } = options;
  if (choice.frame !== undefined && choice.frame !== frame) return; // an impulse acts at its own frame alone
  const scales = computeScales(choice, view, size);
  for (const { row, at, name, vector: compute } of choice.rows) {
    const vector = compute ? compute(poses, frame) : readVector(row, frame);
    const start = at(poses, frame);
    if (!start || ![...start].every(Number.isFinite)) continue;
    const [x, y] = view.project(start);
    if (![...vector].every(Number.isFinite)) {
      const text = formatNumber(norm(vector), row.style); // open or unbounded
      if (values) labels.add(`${row.path} ${name}`, `${name} ${text}`, x, y, colours.faint, 0.8, 10);
      continue;
    }
    const metres = scales.get(isMoment(row));
    const [dx, dy, toward] = view.projectVector(vector.map((component) => component * metres));
    const colour = chooseColour(row, colours);
    const tip = [x + dx, y + dy];
    const [heads, dash] = isMoment(row) ? [2, [6, 3]] : [1, []];
    drawArrow(pen, [x, y], tip, toward * view.scale, colour, colours.panel, heads, dash);
    const text = formatNumber(norm(vector) * row.size, row.style);
    const share = (norm(vector) * metres) / (MAX_LENGTH * view.radius * size);
    if (!values || text === "0" || share < MIN_NUMBERED) continue;
    const label = `${choice.rows.length > 1 ? `${name} ` : ""}${text} ${row.unit}`;
    const rank = MIN_RANK + (MAX_RANK - MIN_RANK) * share;
    labels.add(`${row.path} ${name}`, label, ...tip, colour, rank, LABEL_GAP, findDirection(dx, dy));
  }
}

/** Draw the scales of forces and moments in the lower right corner. @returns {number} how many lines they take */
export function drawArrowScales(pen, view, choice, colours, size, labels) {
  let line = 0;
  for (const [kind, metres] of computeScales(choice, view, size)) {
    if (!(metres > 0)) continue;
    const { row } = choice.rows.find((each) => isMoment(each.row) === kind && getLargest(each.row) > 0);
    const pixels = (metres * view.scale) / row.size;
    const amount = roundBelow(SCALE_LENGTH / pixels);
    const [x, y] = [view.width - 14, view.height - 16 - 20 * line];
    const [start, colour] = [x - amount * pixels, chooseColour(row, colours)];
    drawArrow(pen, [start, y], [x, y], 0, colour, colours.panel, kind ? 2 : 1);
    drawPolyline(pen, [[start, y - 4], [start, y + 4]], colour, 1.5);
    labels.addFixed(`scale ${kind}`, `${formatShort(amount)} ${row.unit} =`, start - 8, y, colour, 10, "right");
    line += 1;
  }
  return line;
}
