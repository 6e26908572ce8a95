/** @file The machine on its canvas: bodies and symbols by depth, then arrows and loads, then all words. */

import { drawLoad, drawLoadScale } from "./loads.js";
import { Painter } from "./painter.js";
import { drawPaths, posesAt, locatePoint } from "./poses.js";
import { paintBodies } from "./solids.js";
import { drawActing, drawMark, nameMark, paintBelt, paintRope } from "./running.js";
import { cleared } from "./strokes.js";
import { drawCorner, drawGroundPoint, paintJoint, paintLine, paintPath } from "./symbols.js";
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

/** Names of bodies and joints. @param {boolean} areNamed whether the arrows name the joints */
function drawNames(labels, scene, poses, view, colours, areNamed) {
  scene.bodies.forEach((body, k) => {
    const [x, y] = view.project(locatePoint(poses, k, middleOf(body)));
    labels.add(`body ${body.name}`, body.caption, x, y, colours.ink, 1.2);
  });
  for (const joint of areNamed ? [] : scene.joints) {
    const [x, y] = view.project(locatePoint(poses, joint.b, joint.q));
    labels.add(`joint ${joint.name}`, joint.caption, x, y, colours.faint, 1, 10);
  }
}

/** What is hidden by what is before it: bodies, symbols, ropes. */
function paintMachine(pen, scene, poses, view, shown, colours) {
  const painter = new Painter(pen);
  const small = scene.joints.length > MANY;
  paintBodies(painter, scene, poses, view, colours);
  for (const path of scene.paths) paintPath(painter, view, path, colours);
  for (const belt of scene.belts) paintBelt(painter, view, poses, belt, colours);
  for (const rope of scene.ropes) paintRope(painter, view, poses, rope, shown, colours);
  for (const line of scene.lines) paintLine(painter, view, poses, scene, line, colours);
  for (const joint of scene.joints) paintJoint(painter, view, poses, scene, joint, colours, small);
  painter.paint(shown.look);
  for (const mark of scene.marks) drawMark(pen, view, scene.symbols[mark.symbol], mark, shown, colours);
  for (const own of small ? [] : scene.acting) drawActing(pen, view, poses, scene, own, colours);
}

/**
 * The machine at a frame.
 * @param {HTMLCanvasElement} canvas @param {object} data @param {import("./view.js").View} view
 * @param {object} shown the frame and what is chosen to be drawn @param {import("./labels.js").LabelList} labels
 */
export function drawMachine(canvas, data, view, shown, colours, labels) {
  const { pen, width, height } = cleared(canvas);
  view.fill(width, height);
  labels.begin(pen, width, height, view.fits);
  const { scene } = data;
  const poses = posesAt(scene, shown.frame, shown.share);
  for (const point of scene.ground) drawGroundPoint(pen, view, point.at, colours);
  if (shown.paths) drawPaths(pen, view, data, colours);
  paintMachine(pen, scene, poses, view, shown, colours);
  if (shown.names) {
    for (const mark of scene.marks) nameMark(labels, view, mark, shown, colours);
    drawNames(labels, scene, poses, view, colours, shown.values && shown.choice?.joints);
  }
  if (shown.load) drawLoad(pen, view, poses, { ...shown.load, ...shown }, colours, labels);
  let line = 0;
  if (shown.choice) {
    drawArrows(pen, view, poses, shown, colours, labels);
    line = drawScale(pen, view, shown.choice, colours, shown.size, labels);
  }
  if (shown.load) drawLoadScale(pen, view, { ...shown.load, size: shown.size }, colours, line, labels);
  drawCorner(pen, view, scene.gravity, colours, labels);
  labels.write(colours.panel);
}
