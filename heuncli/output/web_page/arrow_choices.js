/** @file The sets of force and moment arrows that the user can choose: of joints, couplings, loads, the ground. */

import { rotateDirection, locatePoint } from "./poses.js";
import { norm, scale, normalize } from "./vectors.js";

const MIN_LEVER = 0.003; // of the scene's radius: "all loads" leaves out moments below the largest force times this
/** @type {WeakMap<object, number>} the largest magnitude of each row */
const largestSizes = new WeakMap();

/**
 * @typedef {object} Arrow one force or moment over the frames
 * @property {import("./data.js").Row} row its components, path, unit and style
 * @property {(poses: object[], frame: number) => number[]|null} at its point of action, world axes [m]
 * @property {string} name of what it acts on
 * @property {(poses: object[], frame: number) => number[]} [vector] where the row has one component alone
 */

/** A vector at a frame, SI. @param {import("./data.js").Row} row @param {number} frame @returns {number[]} */
export function readVector(row, frame) {
  return row.parts.map((part) => part.values[row.fixed ? 0 : frame]);
}

/** Get the largest magnitude of a vector over the run, without open and unbounded values. @param {object} row */
export function getLargest(row) {
  if (!largestSizes.has(row)) largestSizes.set(row, findLargest(row));
  return largestSizes.get(row);
}

function findLargest(row) {
  let largest = 0;
  for (let k = 0; k < row.parts[0].values.length; k += 1) {
    const components = row.parts.map((part) => part.values[k]);
    const size = components.length === 1 ? Math.abs(components[0]) : norm(components);
    if (size > largest && size < Infinity) largest = size;
  }
  return largest;
}

/** Whether a row is a moment. @param {import("./data.js").Row} row */
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
  const largest = Math.max(0, ...forces.filter(({ row }) => !isMoment(row)).map(({ row }) => getLargest(row)));
  return applied.filter(({ row }) => !isMoment(row) || getLargest(row) >= MIN_LEVER * radius * largest);
}

/**
 * List the sets of arrows to choose from, without empty ones.
 * @param {import("./data.js").CaseData} data
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
