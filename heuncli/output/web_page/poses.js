/** @file Positions of bodies and points, at a frame or between two while the machine plays, and the paths of joints. */

import { drawPolyline } from "./strokes.js";
import { makeRotationMatrix, add, rotate } from "./vectors.js";

const MAX_TURN = 0.5; // rad between two frames: beyond it interpolation visibly distorts a mechanism, so it is left out
const MAX_PATHS = 24; // joints whose paths are drawn
const MIN_PATH = 1e-4; // of the scene's radius: a joint that moves less stands still
/** @type {WeakMap<object, number[][][]>} the paths of the joints of each scene */
const jointPaths = new WeakMap();

/** @typedef {{place: number[], R: number[]}} Pose origin [m] and attitude; null: the ground */

/**
 * Compute the pose of a body.
 * @param {object} body @param {number} frame @param {number} share of the way to the next frame, 0 to 1
 * @returns {Pose}
 */
function computePose(body, frame, share) {
  const p = body.places;
  const a = body.attitudes;
  const i = 3 * frame;
  const j = 4 * frame;
  const place = [p[i], p[i + 1], p[i + 2]];
  const q = [a[j], a[j + 1], a[j + 2], a[j + 3]];
  if (share > 0 && j + 7 < a.length) {
    const near = q[0] * a[j + 4] + q[1] * a[j + 5] + q[2] * a[j + 6] + q[3] * a[j + 7];
    if (Math.abs(near) > Math.cos(MAX_TURN / 2)) {
      for (let k = 0; k < 3; k += 1) place[k] += share * (p[i + 3 + k] - place[k]);
      for (let k = 0; k < 4; k += 1) q[k] += share * (Math.sign(near) * a[j + 4 + k] - q[k]);
      const size = Math.hypot(...q);
      for (let k = 0; k < 4; k += 1) q[k] /= size;
    }
  }
  return { place, R: makeRotationMatrix(q) };
}

/**
 * Compute the poses of all bodies.
 * @param {import("./data.js").Scene} scene @param {number} frame @param {number} share @returns {Pose[]}
 */
export function computePoses(scene, frame, share) {
  return scene.bodies.map((body) => computePose(body, frame, share));
}

/**
 * Locate a point of a body in world axes [m].
 * @param {Pose[]} poses @param {number} body its number; -1: the ground @param {number[]} point body axes [m]
 * @returns {number[]}
 */
export function locatePoint(poses, body, point) {
  return body < 0 ? point : add(poses[body].place, rotate(poses[body].R, point));
}

/**
 * Read three numbers from a list that has `width` numbers a frame, interpolated to the instant that is shown.
 * @param {ArrayLike<number>} values @param {number} width @param {number} i where they begin within a frame
 * @param {{frame: number, share: number}} instant
 */
export function interpolatePlace(values, width, i, { frame, share }) {
  return [0, 1, 2].map((k) => {
    const from = values[width * frame + i + k];
    const to = values[width * (frame + 1) + i + k];
    return share > 0 && to !== undefined ? from + share * (to - from) : from;
  });
}

/**
 * Rotate a direction of a body into world axes.
 * @param {Pose[]} poses @param {number} body @param {number[]} direction
 */
export function rotateDirection(poses, body, direction) {
  return body < 0 ? direction : rotate(poses[body].R, direction);
}

/** Get the paths of the joints that move, world axes [m]: a point for each frame. @returns {number[][][]} */
function getJointPaths({ scene, count }) {
  if (!jointPaths.has(scene)) jointPaths.set(scene, computeJointPaths(scene, count));
  return jointPaths.get(scene);
}

function computeJointPaths(scene, count) {
  const joints = scene.joints.filter((joint) => joint.a >= 0 || joint.b >= 0).slice(0, MAX_PATHS);
  const paths = joints.map(() => []);
  for (let frame = 0; frame < count; frame += 1) {
    const poses = computePoses(scene, frame, 0);
    joints.forEach((joint, k) => paths[k].push(locatePoint(poses, joint.b, joint.q)));
  }
  const least = MIN_PATH * scene.radius;
  const isMoving = (path) => path.some((place) => place.some((c, i) => Math.abs(c - path[0][i]) > least));
  return paths.filter(isMoving);
}

/** Draw the paths of the joints; they are drawn first, so that the machine stands before them. */
export function drawPaths(pen, view, data, colours) {
  for (const path of getJointPaths(data)) {
    drawPolyline(
      pen,
      path.map((place) => view.project(place)),
      colours.accent,
      1,
    );
  }
}
