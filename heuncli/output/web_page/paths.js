/** @file The ways that the moving joints go over the run, through the frames. */

import { posesAt, stands } from "./poses.js";
import { polyline } from "./strokes.js";

const MOST = 24; // joints whose ways are drawn

/** The ways of the joints that move, world axes [m]: a place for each frame. Made once. @returns {number[][][]} */
function waysOf({ scene, count }) {
  if (scene.ways) return scene.ways;
  const joints = scene.joints.filter((joint) => joint.a >= 0 || joint.b >= 0).slice(0, MOST);
  const ways = joints.map(() => []);
  for (let frame = 0; frame < count; frame += 1) {
    const poses = posesAt(scene, frame, 0);
    joints.forEach((joint, k) => ways[k].push(stands(poses, joint.b, joint.q)));
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
