/** @file Points that cover the machine over its whole motion; the view is fitted to them. */

import { computePoses, locatePoint } from "./poses.js";
import { dot, norm, subtract } from "./vectors.js";

const MAX_FRAMES = 48;
const MAX_POINTS = 60000; // of all frames
const MAX_DISTANCE = 2; // times the machine's radius: what stands farther off its middle is not fitted
const GOLDEN = Math.PI * (3 - Math.sqrt(5));

/** Make directions that are spread evenly over the sphere. @param {number} count */
function spreadDirections(count) {
  return Array.from({ length: count }, (_, k) => {
    const z = 1 - (2 * k + 1) / count;
    const r = Math.sqrt(1 - z * z);
    return [r * Math.cos(GOLDEN * k), r * Math.sin(GOLDEN * k), z];
  });
}

/** Split a list of numbers into points of three. */
export function splitPoints(list) {
  const found = [];
  for (let i = 0; i + 2 < list.length; i += 3) found.push([list[i], list[i + 1], list[i + 2]]);
  return found;
}

/** Find the points of a body that are farthest out in the given directions, body axes. */
function findOutermostPoints(body, directions) {
  const points = body.surfaces.flatMap((surface) => (surface.ball ? [] : splitPoints(surface.corners)));
  points.push(...[...body.bars, ...body.lines].flatMap(splitPoints));
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
export function makeCoverMeasure(scene) {
  const poses = computePoses(scene, 0, 0);
  const joints = scene.joints.map((joint) => locatePoint(poses, joint.b, joint.q));
  const directions = spreadDirections(20);
  const outlines = scene.bodies.map((body, k) =>
    findOutermostPoints(body, directions).map((p) => locatePoint(poses, k, p)),
  );
  const mean = (list, v) => list.reduce((sum, p) => sum + dot(p, v) / list.length, 0);
  const size = (list) => {
    const spans = [0, 1, 2].map((i) => Math.max(...list.map((p) => p[i])) - Math.min(...list.map((p) => p[i])));
    const [, medium, large] = spans.sort((a, b) => a - b);
    return medium * large;
  };
  return (toward) => {
    const middle = mean(joints, toward);
    return outlines.reduce((sum, list) => (list.length ? sum + size(list) * (mean(list, toward) - middle) : sum), 0);
  };
}

/**
 * Collect the points that a view must show: of bodies, joints and ropes at some of the frames, world axes [m].
 * @returns {number[][]}
 */
export function collectCloudPoints(scene, count) {
  const frames = Math.min(count, MAX_FRAMES);
  const share = Math.floor(MAX_POINTS / Math.max(1, frames * scene.bodies.length));
  const directions = spreadDirections(Math.max(8, Math.min(80, share)));
  const outerPoints = scene.bodies.map((body) => findOutermostPoints(body, directions));
  const cloud = [];
  const ends = [...scene.joints, ...scene.lines];
  for (let k = 0; k < frames; k += 1) {
    const frame = frames > 1 ? Math.round((k * (count - 1)) / (frames - 1)) : 0;
    const poses = computePoses(scene, frame, 0);
    outerPoints.forEach((points, body) => points.forEach((p) => cloud.push(locatePoint(poses, body, p))));
    for (const { a, p, b, q } of ends) cloud.push(locatePoint(poses, a, p), locatePoint(poses, b, q));
    for (const { ends: found, count: spans } of scene.ropes) {
      cloud.push(...splitPoints(found.subarray(6 * spans * frame, 6 * spans * (frame + 1))));
    }
  }
  return cloud.filter((p) => norm(subtract(p, scene.center)) <= MAX_DISTANCE * scene.radius);
}
