/** @file The machine on its canvas: objects behind, bodies, what stands on top. */

import { cleared } from "./canvases.js";
import { drawLoad, drawLoadScale } from "./loads.js";
import { Painter } from "./painter.js";
import { drawPaths } from "./paths.js";
import { posesAt, stands } from "./poses.js";
import { paintBodies } from "./solids.js";
import { words } from "./strokes.js";
import { drawActing, drawBelt, drawMark, drawRope, nameMark } from "./running.js";
import { drawCorner, drawGroundPoint, drawJoint, drawLine, drawPath } from "./symbols.js";
import { drawArrows, drawScale } from "./wrenches.js";

const MANY = 40; // joints

/** Where a body's name stands: the middle of what is drawn of it, body axes [m]. */
function middleOf(body) {
  if (body.middle) return body.middle;
  const solid = body.surfaces.map((surface) => surface.ball?.center ?? surface.corners);
  const clouds = solid.length ? solid : body.bars;
  const sum = [0, 0, 0];
  let count = 0;
  for (const cloud of clouds) {
    for (let i = 0; i < cloud.length; i += 1) sum[i % 3] += cloud[i];
    count += cloud.length / 3;
  }
  body.middle = sum.map((c) => (count ? c / count : 0));
  return body.middle;
}

/** Names of bodies and joints. @param {boolean} told whether the arrows tell those of the joints */
function drawNames(pen, scene, poses, view, colours, told) {
  scene.bodies.forEach((body, k) => {
    const [x, y] = view.project(stands(poses, k, middleOf(body)));
    words(pen, body.name, x, y, colours.ink, colours.panel, "center");
  });
  for (const joint of told ? [] : scene.joints) {
    const [x, y] = view.project(stands(poses, joint.b, joint.q));
    words(pen, joint.name, x + 10, y + 11, colours.faint, colours.panel);
  }
}

/**
 * The machine at a frame.
 * @param {HTMLCanvasElement} canvas @param {object} data @param {import("./view.js").View} view
 * @param {object} shown the frame and what is chosen to be drawn
 */
export function drawMachine(canvas, data, view, shown, colours) {
  const { pen, width, height } = cleared(canvas);
  view.fill(width, height);
  const { scene } = data;
  const poses = posesAt(scene, shown.frame, shown.share);
  for (const point of scene.ground) drawGroundPoint(pen, view, point.at, colours);
  if (shown.paths) drawPaths(pen, view, data, colours);
  const painter = new Painter(pen);
  paintBodies(painter, scene, poses, view, colours);
  painter.paint(shown.look);
  for (const path of scene.paths) drawPath(pen, view, path, colours);
  for (const belt of scene.belts) drawBelt(pen, view, poses, belt, shown, colours);
  for (const rope of scene.ropes) drawRope(pen, view, poses, rope, shown, colours);
  for (const line of scene.lines) drawLine(pen, view, poses, line, colours);
  for (const mark of scene.marks) drawMark(pen, view, scene.symbols[mark.symbol], mark, shown, colours);
  if (shown.names) for (const mark of scene.marks) nameMark(pen, view, mark, shown, colours);
  const small = scene.joints.length > MANY;
  for (const own of small ? [] : scene.acting) drawActing(pen, view, poses, scene, own, colours);
  for (const joint of scene.joints) drawJoint(pen, view, poses, joint, colours, small);
  if (shown.load)
    drawLoad(pen, view, poses, { ...shown.load, size: shown.size, tell: shown.values }, shown.frame, colours);
  if (shown.names)
    drawNames(pen, scene, poses, view, colours, shown.values && shown.choice?.key.startsWith("joints.force"));
  let line = 0;
  if (shown.choice) {
    drawArrows(pen, view, poses, shown.choice, shown.frame, colours, shown.size, shown.values);
    line = drawScale(pen, view, shown.choice, colours, shown.size);
  }
  if (shown.load) drawLoadScale(pen, view, { ...shown.load, size: shown.size }, colours, line);
  drawCorner(pen, view, scene.gravity, colours);
}
