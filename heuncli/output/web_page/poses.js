/** @file Where the bodies stand, at a frame or between two of them while the machine plays; the ways of the joints. */

import { polyline } from "./strokes.js";
import { matrixOf, plus, turned } from "./vectors.js";

/** How far a body may turn from one frame to the next to be drawn between them [rad]: farther, and it looks bent. */
const FAR = 0.5;

/** @typedef {{place: number[], R: number[]}} Pose origin [m] and attitude; null: the ground */

/**
 * The pose of a body.
 * @param {object} body @param {number} frame @param {number} share of the way to the next frame, 0 to 1
 * @returns {Pose}
 */
function poseOf(body, frame, share) {
  const p = body.places;
  const a = body.attitudes;
  const i = 3 * frame;
  const j = 4 * frame;
  const place = [p[i], p[i + 1], p[i + 2]];
  const q = [a[j], a[j + 1], a[j + 2], a[j + 3]];
  if (share > 0 && j + 7 < a.length) {
    const near = q[0] * a[j + 4] + q[1] * a[j + 5] + q[2] * a[j + 6] + q[3] * a[j + 7];
    if (Math.abs(near) > Math.cos(FAR / 2)) {
      for (let k = 0; k < 3; k += 1) place[k] += share * (p[i + 3 + k] - place[k]);
      for (let k = 0; k < 4; k += 1) q[k] += share * (Math.sign(near) * a[j + 4 + k] - q[k]);
      const size = Math.hypot(...q);
      for (let k = 0; k < 4; k += 1) q[k] /= size;
    }
  }
  return { place, R: matrixOf(q) };
}

/** The poses of all bodies. @param {object} scene @param {number} frame @param {number} share @returns {Pose[]} */
export function posesAt(scene, frame, share) {
  return scene.bodies.map((body) => poseOf(body, frame, share));
}

/**
 * Where a point of a body stands in the world.
 * @param {Pose[]} poses @param {number} body its number; -1: the ground @param {number[]} point body axes [m]
 * @returns {number[]}
 */
export function locatePoint(poses, body, point) {
  return body < 0 ? point : plus(poses[body].place, turned(poses[body].R, point));
}

/** A direction of a body in world axes. @param {Pose[]} poses @param {number} body @param {number[]} direction */
export function points(poses, body, direction) {
  return body < 0 ? direction : turned(poses[body].R, direction);
}

const MOST = 24; // joints whose ways are drawn

/** The ways of the joints that move, world axes [m]: a place for each frame. Made once. @returns {number[][][]} */
function waysOf({ scene, count }) {
  if (scene.ways) return scene.ways;
  const joints = scene.joints.filter((joint) => joint.a >= 0 || joint.b >= 0).slice(0, MOST);
  const ways = joints.map(() => []);
  for (let frame = 0; frame < count; frame += 1) {
    const poses = posesAt(scene, frame, 0);
    joints.forEach((joint, k) => ways[k].push(locatePoint(poses, joint.b, joint.q)));
  }
  const goes = (way) => way.some((place) => place.some((c, i) => Math.abs(c - way[0][i]) > 1e-4 * scene.radius));
  scene.ways = ways.filter(goes);
  return scene.ways;
}

/** All ways, behind the machine. */
export function drawPaths(pen, view, data, colours) {
  for (const way of waysOf(data)) {
    polyline(
      pen,
      way.map((place) => view.project(place)),
      colours.accent,
      1,
    );
  }
}
