/** @file Forces and moments as arrows, to one scale each: of joints, springs, ropes, drives, the ground, impulses. */

import { roundBelow, formatShort, formatNumber } from "./digits.js";
import { points, locatePoint } from "./poses.js";
import { arrow, polyline } from "./strokes.js";
import { lengthOf, times, unit } from "./vectors.js";

const LONGEST = 0.3; // of the scene's radius: the longest arrow of the run
const LEAST = 4e-3; // of the largest of the run: what is smaller has no words
const LEVER = 0.003; // of the scene's radius: smaller moments than the largest force on it are not among all loads
const NUMBER = 3; // rank of the largest number among the words

/** A vector at a frame, SI. @param {object} row @param {number} frame @returns {number[]} */
export function vectorAt(row, frame) {
  return row.parts.map((part) => part.values[row.fixed ? 0 : frame]);
}

/** The largest size of a vector over the run; what is open does not count. @param {object} row */
export function largestOf(row) {
  if (row.largest === undefined) {
    row.largest = 0;
    for (let k = 0; k < row.parts[0].values.length; k += 1) {
      const size = lengthOf(row.parts.map((part) => part.values[k]));
      if (size > row.largest) row.largest = size;
    }
  }
  return row.largest;
}

/** A row of vectors that stand one after the other. */
function rowOf(vectors, path, row) {
  const parts = [0, 1, 2].map((k) => ({ values: vectors.filter((_, i) => i % 3 === k) }));
  return { ...row, path, parts, largest: undefined };
}

/** The place of a moving point at a frame. */
const placeOf = (at) => (poses, frame) => at.subarray(3 * frame, 3 * frame + 3);

/** The arrow of a coupling's force; its components where no row tells them. */
function ofCoupling(pull, row) {
  const own = pull.forces ? rowOf(pull.forces, row.path, row) : row;
  return { row: own, at: placeOf(pull.at), name: pull.caption, coupling: pull.name };
}

/** The arrow of an applied load: a spring, gas, a bushing, a torque. */
function ofActing(load) {
  const row = rowOf(load.forces, `forces.${load.name}.${load.what}`, load);
  return { row, at: placeOf(load.at), name: load.caption };
}

/** The arrow of a drive, along the axis of its joint. */
function ofDrive(joint, row) {
  const along = (poses) => unit(points(poses, joint.a, joint.axis));
  return {
    row: { ...row, path: `${row.path}.${row.unit.includes("·") ? "moment" : "force"}` },
    at: (poses) => locatePoint(poses, joint.b, joint.q),
    vector: (poses, frame) => times(along(poses), row.parts[0].values[frame]),
    name: `${joint.caption} drive`,
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
  const joint = (j) => (poses) => locatePoint(poses, j.b, j.q);
  const wrench = (begin, what) =>
    scene.joints.flatMap((j) => of(`${begin}joints.${j.name}.${what}`, j.caption, joint(j)));
  const pulls = scene.pulls.filter((pull) => rows.has(pull.row)).map((pull) => ofCoupling(pull, rows.get(pull.row)));
  const drives = scene.joints.flatMap((j) => {
    const row = rows.get(`joints.${j.name}.drive`);
    return row && j.kind in { pin: 1, slide: 1 } ? [ofDrive(j, row)] : [];
  });
  const applied = [...data.acting.map(ofActing), ...drives];
  const single = scene.joints.map((j) => ({
    key: `joints.${j.name}`,
    label: `${j.caption}: force and moment`,
    rows: ["force", "moment"].flatMap((what) => of(`joints.${j.name}.${what}`, j.caption, joint(j))),
  }));
  const axis = rows.get("foundation.axis.point");
  const about = data.foundation;
  const onAxis = (poses, frame) => (axis ? vectorAt(axis, frame) : about);
  const forces = wrench("", "force");
  const pushing = [...forces, ...pulls, ...applied].filter(({ row }) => !turning(row));
  const most = Math.max(0, ...pushing.map(({ row }) => largestOf(row)));
  const shown = applied.filter(({ row }) => !turning(row) || largestOf(row) >= LEVER * scene.radius * most);
  return [
    { key: "all", label: "all loads", rows: [...forces, ...pulls, ...shown], joints: true },
    { key: "joints.force", label: "joint forces", rows: forces, joints: true },
    { key: "joints.moment", label: "joint moments", rows: wrench("", "moment"), joints: true },
    { key: "couplings", label: "gears, belts, ropes", rows: pulls },
    { key: "forces", label: "applied loads and drives", rows: applied },
    {
      key: "foundation",
      label: "load on the ground",
      rows: ["force", "moment"].flatMap((what) => of(`foundation.${what}`, "ground", () => about)),
    },
    {
      key: "foundation.axis",
      label: "load on the ground, central axis",
      rows: of("foundation.force", "ground", onAxis),
    },
    ...data.blows.map((blow) => ({
      key: `blow.${blow.number}`,
      label: `${blow.words}: impulses of all joints`,
      rows: wrench(`impulses.${blow.number}.`, "force"),
      frame: blow.frame,
      joints: true,
    })),
    ...(single.length > 1 ? single : []),
  ].filter((choice) => choice.rows.length);
}

/** How long one SI unit of each kind of vector is drawn, by the unit [m]. */
function scales(choice, view, size) {
  const most = new Map();
  for (const { row } of choice.rows) most.set(turning(row), Math.max(most.get(turning(row)) ?? 0, largestOf(row)));
  const long = LONGEST * view.radius * size;
  return new Map([...most].map(([kind, largest]) => [kind, largest > 0 ? long / largest : 0]));
}

/** Whether a row is a moment. */
const turning = (row) => row.path.endsWith("moment");

/** The colour of a row's arrow. */
const colourOf = (row, colours) => (turning(row) ? colours.moment : colours.force);

/** The arrows of a frame. @param {object} shown what is chosen, and the frame */
export function drawArrows(pen, view, poses, { choice, frame, size, values }, colours, labels) {
  if (choice.frame !== undefined && choice.frame !== frame) return; // an impulse is at its own instant alone
  const metres = scales(choice, view, size);
  for (const { row, at, name, vector: find } of choice.rows) {
    const vector = find ? find(poses, frame) : vectorAt(row, frame);
    const start = at(poses, frame);
    if (!start || ![...start].every(Number.isFinite)) continue;
    const [x, y] = view.project(start);
    if (![...vector].every(Number.isFinite)) {
      if (values) labels.add(`${row.path} ${name}`, `${name} open`, x, y, colours.faint, 0.8, 10);
      continue;
    }
    const long = metres.get(turning(row));
    const [dx, dy, near] = view.direct(vector.map((c) => c * long));
    const colour = colourOf(row, colours);
    const tip = [x + dx, y + dy];
    arrow(pen, [x, y], tip, near * view.scale, colour, colours.panel, turning(row) ? 2 : 1, turning(row) ? [6, 3] : []);
    const text = formatNumber(lengthOf(vector) * row.size, row.style);
    const share = lengthOf(vector) * long / (LONGEST * view.radius * size);
    if (!values || text === "0" || share < LEAST) continue;
    const label = `${choice.rows.length > 1 ? `${name} ` : ""}${text} ${row.unit}`;
    labels.add(`${row.path} ${name}`, label, ...tip, colour, 1.5 + (NUMBER - 1.5) * share);
  }
}

/** How long how much is, in the corner; the number of lines that this takes. */
export function drawScale(pen, view, choice, colours, size, labels) {
  let line = 0;
  for (const [kind, metres] of scales(choice, view, size)) {
    if (!(metres > 0)) continue;
    const { row } = choice.rows.find((each) => turning(each.row) === kind && largestOf(each.row) > 0);
    const pixels = (metres * view.scale) / row.size;
    const amount = roundBelow(90 / pixels);
    const [x, y] = [view.width - 14, view.height - 16 - 20 * line];
    const [begin, colour] = [x - amount * pixels, colourOf(row, colours)];
    arrow(pen, [begin, y], [x, y], 0, colour, colours.panel, kind ? 2 : 1);
    polyline(pen, [[begin, y - 4], [begin, y + 4]], colour, 1.5);
    labels.set(`scale ${kind}`, `${formatShort(amount)} ${row.unit} =`, begin - 8, y, colour, 10, "right");
    line += 1;
  }
  return line;
}
