/** @file The points that the machine fills over its motion: by them a view is fitted to it. */

import { posesAt, locatePoint } from "./poses.js";
import { dot, lengthOf, minus } from "./vectors.js";

const MOST_FRAMES = 48;
const MOST_POINTS = 60000; // of all frames
const FARTHEST = 2; // times the machine's radius: what stands farther off its middle is not fitted
const GOLDEN = Math.PI * (3 - Math.sqrt(5));

/** Directions that are spread evenly. @param {number} count */
function spreadDirections(count) {
  return Array.from({ length: count }, (_, k) => {
    const z = 1 - (2 * k + 1) / count;
    const r = Math.sqrt(1 - z * z);
    return [r * Math.cos(GOLDEN * k), r * Math.sin(GOLDEN * k), z];
  });
}

/** Points of three numbers each, one after the other. */
function pointsOf(list) {
  const found = [];
  for (let i = 0; i + 2 < list.length; i += 3) found.push([list[i], list[i + 1], list[i + 2]]);
  return found;
}

/** The points of a body that are outermost in some directions, body axes. */
function outermost(body, directions) {
  const points = [...body.surfaces.flatMap((s) => (s.ball ? [] : pointsOf(s.corners))), ...body.bars.flatMap(pointsOf)];
  points.push(...body.lines.flatMap(pointsOf));
  for (const { ball } of body.surfaces) {
    if (ball) points.push(...directions.map((d) => d.map((c, i) => ball.center[i] + ball.radius * c)));
  }
  if (points.length <= directions.length) return points;
  const best = directions.map((d) => points.reduce((far, p) => (dot(p, d) > dot(far, d) ? p : far)));
  return [...new Set(best)];
}

/**
 * How much of the machine's bodies stands before its joints, seen from a direction; large bodies count more.
 * @returns {(toward: number[]) => number} positive where large bodies hide the joints
 */
export function coverOf(scene) {
  const poses = posesAt(scene, 0, 0);
  const joints = scene.joints.map((joint) => locatePoint(poses, joint.b, joint.q));
  const directions = spreadDirections(20);
  const looks = scene.bodies.map((body, k) => outermost(body, directions).map((p) => locatePoint(poses, k, p)));
  const mean = (list, v) => list.reduce((sum, p) => sum + dot(p, v) / list.length, 0);
  const size = (list) => {
    const spans = [0, 1, 2].map((i) => Math.max(...list.map((p) => p[i])) - Math.min(...list.map((p) => p[i])));
    const [, middle, large] = spans.sort((a, b) => a - b);
    return middle * large;
  };
  return (toward) => {
    const at = mean(joints, toward);
    return looks.reduce((sum, list) => (list.length ? sum + size(list) * (mean(list, toward) - at) : sum), 0);
  };
}

/** What of a scene is fitted into a view: places in the world at some of its frames. @returns {number[][]} */
export function cloudOf(scene, count) {
  const frames = Math.min(count, MOST_FRAMES);
  const share = Math.floor(MOST_POINTS / Math.max(1, frames * scene.bodies.length));
  const directions = spreadDirections(Math.max(8, Math.min(80, share)));
  const own = scene.bodies.map((body) => outermost(body, directions));
  const cloud = [];
  const ends = [...scene.joints, ...scene.lines];
  for (let k = 0; k < frames; k += 1) {
    const frame = frames > 1 ? Math.round((k * (count - 1)) / (frames - 1)) : 0;
    const poses = posesAt(scene, frame, 0);
    own.forEach((points, body) => points.forEach((p) => cloud.push(locatePoint(poses, body, p))));
    for (const { a, p, b, q } of ends) cloud.push(locatePoint(poses, a, p), locatePoint(poses, b, q));
    for (const { ends: found, count: spans } of scene.ropes) {
      cloud.push(...pointsOf(found.subarray(6 * spans * frame, 6 * spans * (frame + 1))));
    }
  }
  return cloud.filter((p) => lengthOf(minus(p, scene.center)) <= FARTHEST * scene.radius);
}
