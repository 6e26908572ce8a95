/** @file Draws the machine: bodies and symbols by depth, then arrows and section loads, then all labels. */

import { drawArrowScales, drawArrows } from "./arrows.js";
import { splitPoints } from "./cloud.js";
import { paintLine } from "./load_symbols.js";
import { drawLoad, drawLoadScale } from "./loads.js";
import { drawActing, drawMark, nameMark } from "./marks.js";
import { Painter } from "./painter.js";
import { drawPaths, computePoses, locatePoint, rotateDirection } from "./poses.js";
import { paintBodies } from "./solids.js";
import { paintBelt, paintRope } from "./ropes.js";
import { clearCanvas } from "./strokes.js";
import { drawCorner, drawGroundPoint, paintJoint, paintPath } from "./symbols.js";
import { add, cross, norm, normalize, scale, subtract } from "./vectors.js";

const MANY_JOINTS = 40; // with more of them symbols are dots
const MAX_THIN = 22; // largest half thickness [pixels] of a body whose name stands beside it
const SLENDER = 4; // its length is more than so many times that
const NAME_GAP = 8; // pixels between a name and the middle or the edge of its body
/** @type {WeakMap<object, {middle: number[], axis: number[], thickness: number}>} of each body */
const shapes = new WeakMap();

/** The points of what is drawn of a body, body axes [m]. */
function listPoints(body) {
  const balls = body.surfaces.flatMap((surface) => (surface.ball ? [surface.ball.center] : []));
  const lists = body.surfaces.flatMap((surface) => (surface.ball ? [] : [surface.corners]));
  return [...balls, ...(body.surfaces.length ? lists : body.bars).flatMap(splitPoints)];
}

/**
 * Get where the name of a body stands: the middle of what is drawn of it, and its longest axis, from one end to the
 * other, with its thickness across that; body axes [m].
 */
function getShape(body) {
  if (!shapes.has(body)) {
    const points = listPoints(body);
    const middle = points.reduce((sum, p) => add(sum, scale(p, 1 / points.length)), [0, 0, 0]);
    const findFarthest = (from) =>
      points.reduce((far, p) => (norm(subtract(p, from)) > norm(subtract(far, from)) ? p : far), middle);
    const end = findFarthest(middle);
    const axis = subtract(findFarthest(end), end);
    const along = normalize(axis);
    const thickness = points.reduce((most, p) => Math.max(most, norm(cross(along, subtract(p, middle)))), 0);
    shapes.set(body, { middle, axis, thickness });
  }
  return shapes.get(body);
}

/** Write the name of a body at its middle, or beside it where it is so thin that the name would cover it. */
function writeBodyName(labels, body, k, poses, view, colours) {
  const { middle, axis, thickness } = getShape(body);
  const [x, y] = view.project(locatePoint(poses, k, middle));
  const [dx, dy] = view.projectVector(rotateDirection(poses, k, axis));
  const half = thickness * view.scale;
  const length = Math.hypot(dx, dy);
  const isThin = half < MAX_THIN && length > SLENDER * half && length > 1;
  const upward = dx > 0 ? [dy / length, -dx / length] : [-dy / length, dx / length];
  const gap = isThin ? half + NAME_GAP : NAME_GAP;
  labels.add(`body ${body.name}`, body.caption, x, y, colours.ink, 1.2, gap, isThin ? upward : null);
}

/** Write the names of bodies and joints. @param {boolean} areNamed whether the arrows name the joints */
function drawNames(labels, scene, poses, view, colours, areNamed) {
  scene.bodies.forEach((body, k) => writeBodyName(labels, body, k, poses, view, colours));
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
 * @param {HTMLCanvasElement} canvas @param {import("./data.js").CaseData} data @param {import("./view.js").View} view
 * @param {object} options the frame and what is chosen to be drawn @param {import("./labels.js").LabelList} labels
 */
export function drawMachine(canvas, data, view, options, colours, labels) {
  const { pen, width, height } = clearCanvas(canvas);
  view.resize(width, height);
  labels.begin(pen, width, height, view.version);
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
  let scaleRow = 0;
  if (options.choice) {
    drawArrows(pen, view, poses, options, colours, labels);
    scaleRow = drawArrowScales(pen, view, options.choice, colours, options.size, labels);
  }
  if (options.load) drawLoadScale(pen, view, { ...options.load, size: options.size }, colours, scaleRow, labels);
  drawCorner(pen, view, scene.gravity, colours, labels);
  labels.write(colours.panel);
}
