/** @file The sets of force and moment arrows that the user can choose, and how a set is drawn: forces to one scale,
 * moments to another, each with its number. */

import { rememberByObject } from "./data.js";
import { formatNumber, formatShort, roundBelow } from "./digits.js";
import { locatePoint, norm, normalize, rotateDirection, scale } from "./poses.js";
import { drawArrow, drawPolyline } from "./strokes.js";

const MIN_LEVER = 0.003; // of the scene's radius: "all loads" leaves out moments below the largest force times this
const MAX_LENGTH = 0.3; // of the scene's radius: the longest arrow of the run
const MIN_NUMBERED = 4e-3; // of the longest arrow: a shorter one has no number
const MIN_RANK = 1.5; // of a number among the labels: that of the shortest arrow
const MAX_RANK = 3; // that of the longest
const LABEL_GAP = 8; // pixels between a tip and its number
const SCALE_LENGTH = 90; // pixels: no scale bar in the corner is longer

/** A vector at a frame, SI. @param {Row} row @param {number} frame @returns {number[]} */
export function readVector(row, frame) {
  return row.parts.map((part) => part.values[row.fixed ? 0 : frame]);
}

/** Find the largest magnitude of a vector over the run, without open and unbounded values. @param {Row} row */
export const findLargest = rememberByObject((row) => {
  let largest = 0;
  for (let k = 0; k < row.parts[0].values.length; k += 1) {
    const components = row.parts.map((part) => part.values[k]);
    const size = components.length === 1 ? Math.abs(components[0]) : norm(components);
    if (size > largest && size < Infinity) largest = size;
  }
  return largest;
});

/** Whether a row is a moment. @param {Row} row */
export function isMoment(row) {
  return row.path.endsWith("moment");
}

/** Make a row of vectors that are stored one after the other. */
function makeVectorRow(vectors, path, row) {
  const parts = [0, 1, 2].map((k) => ({ values: vectors.filter((_, i) => i % 3 === k) }));
  return { ...row, path, parts };
}

/** Make the function that reads the place of a moving point. @param {Float64Array} places */
const makePlaceReader = (places) => (poses, frame) => places.subarray(3 * frame, 3 * frame + 3);

/** The arrow of a coupling's force; the page's data hold its components where no row has them. */
function makeCouplingArrow(pull, row) {
  const vectorRow = pull.forces ? makeVectorRow(pull.forces, row.path, row) : row;
  return { row: vectorRow, at: makePlaceReader(pull.at), name: pull.caption };
}

/** The arrow of an applied load: spring, gas force, bushing, torque. */
function makeLoadArrow(load) {
  const row = makeVectorRow(load.forces, `forces.${load.name}.${load.what}`, load);
  return { row, at: makePlaceReader(load.at), name: load.caption };
}

/** The arrow of a drive, along the axis of its joint. */
function makeDriveArrow(joint, row) {
  const findAxis = (poses) => normalize(rotateDirection(poses, joint.a, joint.axis));
  return {
    row: { ...row, path: `${row.path}.${row.unit.includes("·") ? "moment" : "force"}` },
    at: (poses) => locatePoint(poses, joint.b, joint.q),
    vector: (poses, frame) => scale(findAxis(poses), row.parts[0].values[frame]),
    name: `${joint.caption} drive`,
  };
}

/** The applied loads without moments that are negligible beside the forces of the whole machine. */
function dropSmallMoments(applied, forces, radius) {
  const largest = Math.max(0, ...forces.filter(({ row }) => !isMoment(row)).map(({ row }) => findLargest(row)));
  return applied.filter(({ row }) => !isMoment(row) || findLargest(row) >= MIN_LEVER * radius * largest);
}

/**
 * List the sets of arrows to choose from, without empty ones.
 * @param {CaseData} data
 * @returns {{key: string, label: string, rows: Arrow[], frame?: number, joints?: boolean}[]}
 *   frame: the only one at which an impulse acts; joints: whether the arrows name the joints
 */
export function listArrowChoices(data) {
  const { rows, scene } = data;
  const findArrows = (path, name, at) => (rows.has(path) ? [{ row: rows.get(path), at, name }] : []);
  const atJoint = (joint) => (poses) => locatePoint(poses, joint.b, joint.q);
  const ofJoint = (prefix, joint, what) =>
    findArrows(`${prefix}joints.${joint.name}.${what}`, joint.caption, atJoint(joint));
  const findJointArrows = (prefix, what) => scene.joints.flatMap((joint) => ofJoint(prefix, joint, what));
  const pulls = scene.pulls.filter((pull) => rows.has(pull.row));
  const couplings = pulls.map((pull) => makeCouplingArrow(pull, rows.get(pull.row)));
  const drives = scene.joints.flatMap((joint) => {
    const row = rows.get(`joints.${joint.name}.drive`);
    return row && ["pin", "slide"].includes(joint.kind) ? [makeDriveArrow(joint, row)] : [];
  });
  const applied = [...data.acting.map(makeLoadArrow), ...drives];
  const forces = findJointArrows("", "force");
  const shown = dropSmallMoments(applied, [...forces, ...couplings, ...applied], scene.radius);
  const axis = rows.get("foundation.axis.point");
  const momentCenter = () => data.foundation;
  const axisPoint = (poses, frame) => (axis ? readVector(axis, frame) : data.foundation);
  const singleJoints = scene.joints.map((joint) => ({
    key: `joints.${joint.name}`,
    label: `${joint.caption}: force and moment`,
    rows: ["force", "moment"].flatMap((what) => ofJoint("", joint, what)),
  }));
  return [
    { key: "all", label: "all loads", rows: [...forces, ...couplings, ...shown], joints: true },
    { key: "joints.force", label: "joint forces", rows: forces, joints: true },
    { key: "joints.moment", label: "joint moments", rows: findJointArrows("", "moment"), joints: true },
    { key: "couplings", label: "gears, belts, ropes", rows: couplings },
    { key: "forces", label: "applied loads and drives", rows: applied },
    {
      key: "foundation",
      label: "load on the ground",
      rows: ["force", "moment"].flatMap((what) => findArrows(`foundation.${what}`, "ground", momentCenter)),
    },
    {
      key: "foundation.axis",
      label: "load on the ground, central axis",
      rows: findArrows("foundation.force", "ground", axisPoint),
    },
    ...data.impulses.map((impulse) => ({
      key: `impulse.${impulse.number}`,
      label: `${impulse.words}: impulses of all joints`,
      rows: findJointArrows(`impulses.${impulse.number}.`, "force"),
      frame: impulse.frame,
      joints: true,
    })),
    ...(singleJoints.length > 1 ? singleJoints : []),
  ].filter((choice) => choice.rows.length);
}

/** The length of one SI unit [m], for forces (key false) and for moments (key true). */
function computeScales(choice, view, size) {
  const largest = new Map();
  for (const { row } of choice.rows) {
    largest.set(isMoment(row), Math.max(largest.get(isMoment(row)) ?? 0, findLargest(row)));
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
    labels.avoid([x, y], tip);
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
    const { row } = choice.rows.find((each) => isMoment(each.row) === kind && findLargest(each.row) > 0);
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
