/** @file Draws the machine: bodies and symbols by depth, then arrows and section loads, then all labels. */

import { drawArrowScales, drawArrows } from "./arrows.js";
import { paintLine } from "./load_symbols.js";
import { drawLoad, drawLoadScale } from "./loads.js";
import { drawActing, drawMark, nameMark } from "./marks.js";
import { Painter } from "./painter.js";
import { drawPaths, computePoses, locatePoint } from "./poses.js";
import { paintBodies } from "./solids.js";
import { paintBelt, paintRope } from "./ropes.js";
import { clearCanvas } from "./strokes.js";
import { drawCorner, drawGroundPoint, paintJoint, paintPath } from "./symbols.js";


const MANY_JOINTS = 40; // joints

/** Get the middle of what is drawn of a body, body axes [m], where its name stands. */
function getMiddle(body) {
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

/** Write the names of bodies and joints. @param {boolean} areNamed whether the arrows name the joints */
function drawNames(labels, scene, poses, view, colours, areNamed) {
  scene.bodies.forEach((body, k) => {
    const [x, y] = view.project(locatePoint(poses, k, getMiddle(body)));
    labels.add(`body ${body.name}`, body.caption, x, y, colours.ink, 1.2);
  });
  for (const joint of areNamed ? [] : scene.joints) {
    const [x, y] = view.project(locatePoint(poses, joint.b, joint.q));
    labels.add(`joint ${joint.name}`, joint.caption, x, y, colours.faint, 1, 10);
  }
}

/** Paint bodies, ropes and symbols by depth; the symbols of marks stand before all. */
function paintMachine(pen, scene, poses, view, options, colours) {
  const painter = new Painter(pen);
  const small = scene.joints.length > MANY_JOINTS;
  paintBodies(painter, scene, poses, view, colours);
  for (const path of scene.paths) paintPath(painter, view, path, colours);
  for (const belt of scene.belts) paintBelt(painter, view, poses, belt, colours);
  for (const rope of scene.ropes) paintRope(painter, view, poses, rope, options, colours);
  for (const line of scene.lines) paintLine(painter, view, poses, scene, line, colours);
  for (const joint of scene.joints) paintJoint(painter, view, poses, scene, joint, colours, small);
  painter.paint(options.opacity);
  for (const mark of scene.marks) drawMark(pen, view, scene.symbols[mark.symbol], mark, options, colours);
  for (const own of small ? [] : scene.acting) drawActing(pen, view, poses, scene, own, colours);
}

/**
 * Draw the machine at a frame.
 * @param {HTMLCanvasElement} canvas @param {object} data @param {import("./view.js").View} view
 * @param {object} options the frame and what is chosen to be drawn @param {import("./labels.js").LabelList} labels
 */
export function drawMachine(canvas, data, view, options, colours, labels) {
  const { pen, width, height } = clearCanvas(canvas);
  view.resize(width, height);
  labels.begin(pen, width, height, view.fits);
  const { scene } = data;
  const poses = computePoses(scene, options.frame, options.share);
  for (const point of scene.ground) drawGroundPoint(pen, view, point.at, colours);
  if (options.paths) drawPaths(pen, view, data, colours);
  paintMachine(pen, scene, poses, view, options, colours);
  if (options.names) {
    for (const mark of scene.marks) nameMark(labels, view, mark, options, colours);
    drawNames(labels, scene, poses, view, colours, options.values && options.choice?.joints);
  }
  if (options.load) drawLoad(pen, view, poses, { ...options.load, ...options }, colours, labels);
  let line = 0;
  if (options.choice) {
    drawArrows(pen, view, poses, options, colours, labels);
    line = drawArrowScales(pen, view, options.choice, colours, options.size, labels);
  }
  if (options.load) drawLoadScale(pen, view, { ...options.load, size: options.size }, colours, line, labels);
  drawCorner(pen, view, scene.gravity, colours, labels);
  labels.write(colours.panel);
}
