/** @file Draws the machine: bodies and symbols by depth, then arrows and section loads, then all labels. */

import { drawArrows, drawArrowScales } from "./arrows.js";
import { rememberByObject } from "./data.js";
import { drawActing, drawMark, nameMark, paintBelt, paintLine, paintRope } from "./load_symbols.js";
import { drawLoad, drawLoadScale } from "./loads.js";
import { Painter } from "./painter.js";
import { add, computePoses, cross, locatePoint, norm, normalize, rotateDirection, scale, subtract } from "./poses.js";
import { paintBodies } from "./solids.js";
import { clearCanvas, drawPolyline } from "./strokes.js";
import { drawCorner, drawGroundPoint, paintJoint, paintPath } from "./symbols.js";
import { splitPoints } from "./view.js";

const MANY_JOINTS = 40; // with more of them symbols are dots
const MAX_THIN = 22; // largest half thickness [pixels] of a body whose name stands beside it
const SLENDER = 4; // its length is more than so many times that
const MAX_PATHS = 24; // joints whose paths are drawn
const MIN_PATH = 1e-4; // of the scene's radius: a joint that moves less stands still
const NAME_GAP = 8; // pixels between a name and the middle or the edge of its body

/** The points of what is drawn of a body, body axes [m]. */
function listPoints(body) {
  const balls = body.surfaces.flatMap((surface) => (surface.ball ? [surface.ball.center] : []));
  const lists = body.surfaces.flatMap((surface) => (surface.ball ? [] : [surface.corners]));
  return [...balls, ...(body.surfaces.length ? lists : body.bars).flatMap(splitPoints)];
}

/**
 * Find the middle of what is drawn of a body, and its longest axis, from one end to the other, with its thickness
 * across that; body axes [m]. The place of its name depends on them.
 */
const findSlenderShape = rememberByObject((body) => {
  const points = listPoints(body);
  const middle = points.reduce((sum, p) => add(sum, scale(p, 1 / points.length)), [0, 0, 0]);
  const findFarthest = (from) =>
    points.reduce((far, p) => (norm(subtract(p, from)) > norm(subtract(far, from)) ? p : far), middle);
  const end = findFarthest(middle);
  const axis = subtract(findFarthest(end), end);
  const along = normalize(axis);
  const thickness = points.reduce((most, p) => Math.max(most, norm(cross(along, subtract(p, middle)))), 0);
  return { middle, axis, thickness };
});

/**
 * Compute the paths of the joints that move, world axes [m]: a point for each frame.
 * @type {(data: CaseData) => Vector[][]}
 */
const computeJointPaths = rememberByObject(({ scene, count }) => {
  const joints = scene.joints.filter((joint) => joint.a >= 0 || joint.b >= 0).slice(0, MAX_PATHS);
  const paths = joints.map(() => []);
  for (let frame = 0; frame < count; frame += 1) {
    const poses = computePoses(scene, frame, 0);
    joints.forEach((joint, k) => paths[k].push(locatePoint(poses, joint.b, joint.q)));
  }
  const least = MIN_PATH * scene.radius;
  const isMoving = (path) => path.some((place) => place.some((c, i) => Math.abs(c - path[0][i]) > least));
  return paths.filter(isMoving);
});

/** Draw the paths of the joints; they are drawn first, so that the machine stands before them. */
function drawPaths(pen, view, data, colours) {
  for (const path of computeJointPaths(data)) {
    const places = path.map((place) => view.project(place));
    drawPolyline(pen, places, colours.accent, 1);
  }
}

/** Write the name of a body at its middle, or beside it where it is so thin that the name would cover it. */
function writeBodyName(labels, body, k, poses, view, colours) {
  const { middle, axis, thickness } = findSlenderShape(body);
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
 * @param {HTMLCanvasElement} canvas @param {CaseData} data @param {View} view
 * @param {object} options the frame and what is chosen to be drawn @param {LabelList} labels
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
