/** @file Symbols of what acts between bodies or on them: springs, dampers, actuators, bushings, belts, ropes, stops,
 * latches, and loads and drives in joints. */

import {
  add,
  cross,
  dot,
  interpolatePlace,
  locatePoint,
  normalize,
  rotateDirection,
  scale,
  subtract,
} from "./poses.js";
import { drawPolyline, drawRing, drawShape } from "./strokes.js";
import { computeDepth, drawStand, makePlacer } from "./symbols.js";

const COILS = 7;
const ARC_STEP = 0.1; // rad: an arc is drawn as chords of at most this angle
const WIDTH = 2; // pixels
const MIN_VISIBLE = 0.2; // share of a direction that the view must show, else its side on the screen is arbitrary
const LINE_WIDTH = 1.3;

/** Draw a bushing: two sleeves about its `to` point with rubber between them. */
function drawBushing(pen, view, line, a, b, colours) {
  drawPolyline(pen, [a, b], colours.ink, 1);
  if (line.a < 0 || line.b < 0) drawStand(pen, view, line.a < 0 ? a : b, colours);
  drawRing(pen, b[0], b[1], 9, colours.paper, colours.ink, 1.8);
  for (let k = 0; k < 6; k += 1) {
    const [x, y] = [Math.cos((k * Math.PI) / 3), Math.sin((k * Math.PI) / 3)];
    drawPolyline(
      pen,
      [
        [b[0] + 4 * x, b[1] + 4 * y],
        [b[0] + 8.4 * x, b[1] + 8.4 * y],
      ],
      colours.ink,
      1.2,
    );
  }
  drawRing(pen, b[0], b[1], 3.4, colours.paper, colours.ink, 1.8);
}

/** Draw the zigzag of a spring, offset from the line between its ends. */
function drawCoil(pen, at, aside, wide, colours) {
  const turns = [];
  for (let k = 0; k < 2 * COILS; k += 1) {
    turns.push(at(0.15 + (0.7 * (k + 0.5)) / (2 * COILS), aside + (k % 2 ? wide : -wide)));
  }
  drawPolyline(pen, [at(0), at(0.12), at(0.15, aside), ...turns, at(0.85, aside), at(0.88), at(1)], colours.ink, 1.5);
}

/** Draw the cup and the plate of a damper. */
function drawDashpot(pen, at, aside, colours) {
  drawPolyline(pen, [at(0.12), at(0.12, aside), at(0.4, aside)], colours.ink, 1.5);
  const cup = [at(0.62, aside + 5), at(0.4, aside + 5), at(0.4, aside - 5), at(0.62, aside - 5)];
  drawPolyline(pen, cup, colours.ink, 1.5);
  drawPolyline(pen, [at(0.55, aside + 3.5), at(0.55, aside - 3.5)], colours.ink, 1.8);
  drawPolyline(pen, [at(0.55, aside), at(0.88, aside), at(0.88)], colours.ink, 1.5);
}

/**
 * By symbol of the load kinds (base/load_kinds.py); at(share, aside): a point of the line between the ends [pixels].
 */
const LINES = {
  spring: (pen, at, colours) => drawCoil(pen, at, 0, 6, colours),
  "damped spring": (pen, at, colours) => {
    drawCoil(pen, at, -8, 5, colours);
    drawDashpot(pen, at, 8, colours);
  },
  actuator: (pen, at, colours) => {
    drawPolyline(pen, [at(0), at(1)], colours.ink, 1.8);
    drawShape(pen, [at(0.12, 5), at(0.58, 5), at(0.58, -5), at(0.12, -5)], colours.paper, colours.ink, 1.5);
    drawPolyline(pen, [at(0.45, 5), at(0.45, -5)], colours.ink, 1.5);
  },
};

/** Draw a load between two points by its symbol. */
function drawLine(pen, view, poses, line, colours) {
  const a = view.project(locatePoint(poses, line.a, line.p));
  const b = view.project(locatePoint(poses, line.b, line.q));
  if (line.kind === "bushing") {
    drawBushing(pen, view, line, a.slice(0, 2), b.slice(0, 2), colours);
    return;
  }
  const long = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
  const place = makePlacer(a, [(b[0] - a[0]) / long, (b[1] - a[1]) / long]);
  LINES[line.kind](pen, (share, aside = 0) => place(share * long, aside), colours);
  for (const [x, y] of [a, b]) drawRing(pen, x, y, 2.5, colours.paper, colours.ink, 1.3);
}

/** Give the painter a load between two points. */
export function paintLine(painter, view, poses, scene, line, colours) {
  const ends = [view.project(locatePoint(poses, line.a, line.p)), view.project(locatePoint(poses, line.b, line.q))];
  painter.add(computeDepth(view, scene, line.a, line.b, ends), (pen) => drawLine(pen, view, poses, line, colours));
}

/** Give the painter a line through world places, at the depth of its middle. */
function paintStrand(painter, view, line, colours) {
  const projected = line.map((place) => view.project(place));
  const near = projected.reduce((sum, place) => sum + place[2], 0) / projected.length;
  painter.add(near, (pen) => drawPolyline(pen, projected, colours.ink, WIDTH));
}

/** Paint a belt; its strands are in the axes of the body that carries its pulleys. */
export function paintBelt(painter, view, poses, { body, strands }, colours) {
  for (let i = 0; i < strands.length; i += 6) {
    paintStrand(painter, view, [i, i + 3].map((k) => locatePoint(poses, body, strands.subarray(k, k + 3))), colours);
  }
}

/** Make the arc from one point to another about an axis through a centre, counter-clockwise seen from its tip. */
function makeArc(center, axis, start, end) {
  const r = subtract(start, center);
  const to = subtract(end, center);
  const turn = Math.atan2(dot(axis, cross(r, to)), dot(r, to));
  const angle = turn < 0 ? turn + 2 * Math.PI : turn;
  const steps = Math.max(1, Math.ceil(angle / ARC_STEP));
  const aside = cross(axis, r);
  const points = [];
  for (let k = 0; k <= steps; k += 1) {
    const a = (angle * k) / steps;
    points.push(add(center, add(scale(r, Math.cos(a)), scale(aside, Math.sin(a)))));
  }
  return points;
}

/** Paint a rope from end to end, its strands and its arcs. */
export function paintRope(painter, view, poses, rope, options, colours) {
  const width = 6 * rope.count;
  const ends = [];
  for (let i = 0; i < width; i += 3) ends.push(interpolatePlace(rope.ends, width, i, options));
  const arcs = new Map(rope.arcs.map((each) => [each.before, each]));
  for (let k = 0; k < rope.count; k += 1) {
    paintStrand(painter, view, [ends[2 * k], ends[2 * k + 1]], colours);
    const contact = arcs.get(k);
    if (!contact) continue;
    const center = locatePoint(poses, contact.body, contact.center);
    const axis = rotateDirection(poses, contact.along, contact.axis);
    paintStrand(painter, view, makeArc(center, axis, ends[2 * k + 1], ends[2 * k + 2]), colours);
  }
}

/** The frame from which a mark's place is read: one that never moves is stored for frame 0 alone. */
const findMarkFrame = (mark, options) => (mark.places.length > 3 ? options : { frame: 0, share: 0 });

/** Draw a symbol about a point of the screen, its x axis along a unit vector there. */
function drawSymbol(pen, parts, [x, y], [u, v], colours) {
  for (const part of parts) {
    const corners = part.points.map(([p, q]) => [x + p * u + q * v, y + p * v - q * u]);
    if (part.closed) drawShape(pen, corners, part.fill ? colours[part.fill] : "transparent", colours.ink, LINE_WIDTH);
    else drawPolyline(pen, corners, colours.ink, LINE_WIDTH);
  }
}

/** Draw a mark along its direction; it is left out where that points at the viewer. */
export function drawMark(pen, view, parts, mark, options, colours) {
  const at = findMarkFrame(mark, options);
  const [a, b] = view.projectVector(normalize(interpolatePlace(mark.ways, 3, 0, at)));
  const size = Math.hypot(a, b);
  if (size > MIN_VISIBLE * view.scale)
    drawSymbol(pen, parts, view.project(interpolatePlace(mark.places, 3, 0, at)), [a / size, b / size], colours);
}

/** Draw the symbol of a load or drive in a joint; an axis that points away shows the mirrored symbol. */
export function drawActing(pen, view, poses, scene, acting, colours) {
  const joint = scene.joints[acting.joint];
  if (joint.kind === "curve") return; // its direction changes along its path
  const [a, b, near] = view.projectVector(normalize(rotateDirection(poses, joint.a, joint.axis)));
  const size = Math.hypot(a, b);
  const along = acting.slides && size > MIN_VISIBLE * view.scale ? [a / size, b / size] : [1, 0];
  const at = view.project(locatePoint(poses, joint.b, joint.q));
  drawSymbol(pen, scene.symbols[acting.symbols[near < 0 ? 1 : 0]], at, along, colours);
}

/** Write the name of a mark beside it, if it has one. */
export function nameMark(labels, view, mark, options, colours) {
  if (!mark.name) return;
  const [x, y] = view.project(interpolatePlace(mark.places, 3, 0, findMarkFrame(mark, options)));
  labels.add(`mark ${mark.name} ${mark.symbol}`, mark.name, x, y, colours.faint, 1, 10);
}
