/** @file Forces and moments as arrows: of joints, of the foundation, of blows; to one scale over the whole run. */

import { roundBelow, short, written } from "./digits.js";
import { stands } from "./poses.js";
import { arrow, polyline, words } from "./strokes.js";
import { lengthOf } from "./vectors.js";

const LONGEST = 0.42; // of the scene's radius: the longest arrow of the run
const MOST_WORDS = 12;

/** A vector at a frame, SI. @param {object} row @param {number} frame @returns {number[]} */
export function vectorAt(row, frame) {
  return row.parts.map((part) => part.values[row.fixed ? 0 : frame]);
}

/** The largest size of a vector over the run; what is open does not count. @param {object} row */
export function largestOf(row) {
  let most = 0;
  for (let k = 0; k < row.parts[0].values.length; k += 1) {
    const size = lengthOf(row.parts.map((part) => part.values[k]));
    if (size > most) most = size;
  }
  return most;
}

/** The arrow of a coupling's force; its components where no row tells them. */
function ofCoupling(pull, row) {
  const vector = pull.forces && [0, 1, 2].map((k) => ({ values: pull.forces.filter((_, i) => i % 3 === k) }));
  return {
    row: vector ? { ...row, parts: vector } : row,
    at: (poses, frame) => pull.at.subarray(3 * frame, 3 * frame + 3),
    name: `${pull.name} on ${pull.on}`,
    coupling: pull.name,
  };
}

/**
 * What arrows there are to choose from.
 * @param {object} data
 * @returns {{key: string, label: string, rows: object[]}[]} of each row its numbers, where it stands, its name
 */
export function arrowChoices(data) {
  const { rows, scene } = data;
  const of = (path, name, at) => (rows.has(path) ? [{ row: rows.get(path), at, name }] : []);
  const joint = (j) => (poses) => stands(poses, j.b, j.q);
  const wrench = (begin, what) => scene.joints.flatMap((j) => of(`${begin}joints.${j.name}.${what}`, j.name, joint(j)));
  const pulls = scene.pulls.filter((pull) => rows.has(pull.row)).map((pull) => ofCoupling(pull, rows.get(pull.row)));
  const coupled = [...new Set(scene.pulls.map((pull) => pull.name))].map((name) => ({
    key: `couplings.${name}`,
    label: `${name}: force`,
    rows: pulls.filter((pull) => pull.coupling === name),
  }));
  const single = scene.joints.map((j) => ({
    key: `joints.${j.name}`,
    label: `${j.name}: force and moment`,
    rows: ["force", "moment"].flatMap((what) => of(`joints.${j.name}.${what}`, j.name, joint(j))),
  }));
  const axis = rows.get("foundation.axis.point");
  const about = data.foundation;
  const onAxis = (poses, frame) => (axis ? vectorAt(axis, frame) : about);
  return [
    {
      key: "joints.force",
      label: pulls.length ? "forces of all joints and couplings" : "forces of all joints",
      rows: [...wrench("", "force"), ...pulls],
    },
    { key: "joints.moment", label: "moments of all joints", rows: wrench("", "moment") },
    ...single,
    ...coupled,
    {
      key: "foundation",
      label: "foundation: force and moment",
      rows: ["force", "moment"].flatMap((what) => of(`foundation.${what}`, "foundation", () => about)),
    },
    {
      key: "foundation.axis",
      label: "foundation: force on the central axis",
      rows: of("foundation.force", "foundation", onAxis),
    },
    ...data.blows.map((blow) => ({
      key: `blow.${blow.number}`,
      label: `${blow.words}: impulses of all joints`,
      rows: wrench(`impulses.${blow.number}.`, "force"),
      frame: blow.frame,
    })),
  ].filter((choice) => choice.rows.length);
}

/** How long one SI unit of each kind of vector is drawn, by the unit [m]. */
function scales(choice, view, size) {
  const most = new Map();
  for (const { row } of choice.rows) {
    row.largest ??= largestOf(row);
    most.set(row.unit, Math.max(most.get(row.unit) ?? 0, row.largest));
  }
  const long = LONGEST * view.radius * size;
  return new Map([...most].map(([unit, largest]) => [unit, largest > 0 ? long / largest : 0]));
}

/** Whether a row is a moment. */
const turning = (row) => row.path.endsWith("moment");

/**
 * The arrows of a frame.
 * @param {number} size by how much longer than usual they are drawn
 */
export function drawArrows(pen, view, poses, choice, frame, colours, size, tell) {
  if (choice.frame !== undefined && choice.frame !== frame) return; // an impulse is at its own instant alone
  const metres = scales(choice, view, size);
  for (const { row, at, name } of choice.rows) {
    const vector = vectorAt(row, frame);
    const start = at(poses, frame);
    if (!start?.every(Number.isFinite)) continue;
    const [x, y] = view.project(start);
    const many = choice.rows.length > MOST_WORDS;
    if (!vector.every(Number.isFinite)) {
      if (tell && !many) words(pen, `${name} open`, x + 10, y - 12, colours.faint, colours.panel);
      continue;
    }
    const [dx, dy, near] = view.direct(vector.map((c) => c * metres.get(row.unit)));
    const moment = turning(row);
    const colour = moment ? colours.moment : colours.force;
    arrow(
      pen,
      [x, y],
      [x + dx, y + dy],
      near * view.scale,
      colour,
      colours.panel,
      moment ? 2 : 1,
      moment ? [6, 3] : [],
    );
    const text = written(lengthOf(vector) * row.size, row.style);
    if (tell && !many && text !== "0") {
      const label = `${choice.rows.length > 1 ? `${name} ` : ""}${text} ${row.unit}`;
      const [align, aside] = dx < 0 ? ["right", -6] : ["left", 6];
      words(pen, label, x + dx + aside, y + dy + (dy > 0 ? 9 : -9), colour, colours.panel, align);
    }
  }
}

/** How long how much is, in the corner; the number of lines that this takes. */
export function drawScale(pen, view, choice, colours, size) {
  let line = 0;
  for (const [unit, metres] of scales(choice, view, size)) {
    if (!(metres > 0)) continue;
    const row = choice.rows.find((each) => each.row.unit === unit).row;
    const pixels = (metres * view.scale) / row.size;
    const amount = roundBelow(90 / pixels);
    const [x, y] = [view.width - 14, view.height - 16 - 20 * line];
    const colour = turning(row) ? colours.moment : colours.force;
    arrow(pen, [x - amount * pixels, y], [x, y], 0, colour, colours.panel, turning(row) ? 2 : 1);
    polyline(
      pen,
      [
        [x - amount * pixels, y - 4],
        [x - amount * pixels, y + 4],
      ],
      colour,
      1.5,
    );
    words(pen, `${short(amount)} ${unit} =`, x - amount * pixels - 8, y, colour, colours.panel, "right");
    line += 1;
  }
  return line;
}
