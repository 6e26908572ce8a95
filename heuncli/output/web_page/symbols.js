/** @file Symbols of joints and the ground, as engineers draw them, and the world's axes in the corner. */

import { rememberByObject } from "./data.js";
import { cross, locatePoint, norm, normalize, rotateDirection } from "./poses.js";
import { drawArrow, drawPolyline, drawRing, drawShape } from "./strokes.js";

const R = 5.5; // pixels: radius of a joint
const DOT = 2; // pixels: radius of one of many joints
const STAND = 15; // pixels: from a joint to the ground that holds it
const HALF = 12; // pixels: half of the line of ground under a joint
const GUIDE = 0.11; // of the scene: half of a guide's rails
const MAX_OFFSET = 0.3; // of the scene's radius: a symbol is drawn before no body that is nearer than that
const CLEARANCE = 0.01; // of the scene's radius, beyond the face
const CORNER = 30; // pixels: length of the axes of the world

/** Project a direction to a unit vector of the screen; null if it points at the viewer. */
function projectDirection(view, v) {
  const [x, y] = view.projectVector(normalize(v));
  const size = Math.hypot(x, y);
  return size > 0.15 * view.scale ? [x / size, y / size] : null;
}

/** Make the function that finds a point of the screen, given pixels along a direction and pixels to its right. */
export function makePlacer([x, y], [ux, uy]) {
  return (along, aside = 0) => [x + along * ux - aside * uy, y + along * uy + aside * ux];
}

/** Draw the ground: a hatched line; n: unit vector into the ground. */
function drawHatchedGround(pen, at, n, half, colours) {
  const place = makePlacer(at, n);
  drawPolyline(pen, [place(0, -half), place(0, half)], colours.ink, 1.6);
  for (let t = -half + 3; t <= half; t += 5) drawPolyline(pen, [place(0, t), place(5, t - 3.5)], colours.ink, 1);
}

/** Draw the stand between a joint and the ground. */
export function drawStand(pen, view, at, colours) {
  const down = view.up.map((component) => -component);
  const n = projectDirection(view, down) ?? [0, 1];
  const place = makePlacer(at, n);
  drawShape(pen, [at, place(STAND, -8), place(STAND, 8)], colours.paper, colours.ink, 1.4);
  drawHatchedGround(pen, place(STAND), n, HALF, colours);
}

/** Draw a joint that fixes a point, by its kind; along: the joint's axis on the screen, or null. */
const AT_POINT = {
  ball: (pen, [x, y], along, colours) => {
    drawRing(pen, x, y, R, colours.paper, colours.ink, 1.8);
    drawRing(pen, x, y, R - 2.8, colours.ink, colours.ink, 1);
  },
  pin: (pen, [x, y], along, colours) => {
    const place = along && makePlacer([x, y], along);
    if (place) drawPolyline(pen, [place(-2 * R), place(2 * R)], colours.ink, 2);
    drawRing(pen, x, y, R, colours.paper, colours.ink, 1.8);
    drawRing(pen, x, y, 1.2, colours.ink, colours.ink, 1);
  },
  universal: (pen, [x, y], along, colours) => {
    const place = makePlacer([x, y], along ?? [1, 0]);
    drawRing(pen, x, y, R, colours.paper, colours.ink, 1.8);
    drawPolyline(pen, [place(-R), place(R)], colours.ink, 1.5);
    drawPolyline(pen, [place(0, -R), place(0, R)], colours.ink, 1.5);
  },
  cv: (pen, at, along, colours) => {
    drawRing(pen, ...at, R, colours.paper, colours.ink, 1.8);
    const place = makePlacer(at, [1, 0]);
    for (const [x, y] of [[0, -R], [0.87 * R, 0.5 * R], [-0.87 * R, 0.5 * R]]) {
      drawPolyline(pen, [at, place(x, y)], colours.ink, 1.5);
    }
  },
  weld: (pen, at, along, colours) => {
    const place = makePlacer(at, [1, 0]);
    drawShape(pen, [place(-5, -5), place(5, -5), place(5, 5), place(-5, 5)], colours.ink, colours.paper, 1);
  },
};

/** Draw rails along a world direction, the first of them hatched if it belongs to the ground. */
function drawRails(pen, view, at, along, grounded, colours, sides) {
  const u = projectDirection(view, along);
  if (!u) return;
  const n = u[0] >= 0 ? u : [-u[0], -u[1]]; // so that the ground is below
  const place = makePlacer(at, n);
  const half = Math.max(16, Math.min(60, GUIDE * view.radius * view.scale));
  sides.forEach((side, k) => {
    drawPolyline(pen, [place(-half, side), place(half, side)], colours.ink, 1.5);
    if (grounded && k === 0) drawHatchedGround(pen, place(0, side), [-n[1], n[0]], half, colours);
  });
}

/** Draw a block between rails. */
function drawBlock(pen, view, at, axis, grounded, colours) {
  const place = makePlacer(at, projectDirection(view, axis) ?? [1, 0]);
  drawRails(pen, view, at, axis, grounded, colours, [9, -9]);
  drawShape(pen, [place(-10, -6), place(10, -6), place(10, 6), place(-10, 6)], colours.paper, colours.ink, 1.8);
}

/** Draw a roller on rails. */
function drawRoller(pen, view, at, along, grounded, colours, sides) {
  if (norm(along) > 0.1) drawRails(pen, view, at, along, grounded, colours, sides);
  drawRing(pen, at[0], at[1], R, colours.paper, colours.ink, 1.8);
  drawRing(pen, at[0], at[1], 1.2, colours.ink, colours.ink, 1);
}

/** Draw a joint whose point slides, by its kind. */
const SLIDING = {
  slide: drawBlock,
  cylinder: (pen, view, at, axis, grounded, colours) => {
    drawBlock(pen, view, at, axis, grounded, colours);
    drawRing(pen, at[0], at[1], 3, colours.paper, colours.ink, 1.4);
  },
  line: (pen, view, at, axis, grounded, colours) => {
    drawRoller(pen, view, at, axis, grounded, colours, [R + 2, -R - 2]);
  },
  plane: (pen, view, at, normal, grounded, colours) => {
    drawRoller(pen, view, at, cross(normal, view.toward), grounded, colours, [R + 2]);
  },
};

/** Draw a rod between two points. */
function drawRod(pen, joint, from, at, colours) {
  drawPolyline(pen, [from, at], colours.ink, 2, []);
  for (const [[x, y], other, body] of [
    [from, at, joint.a],
    [at, from, joint.b],
  ]) {
    const size = Math.hypot(x - other[0], y - other[1]) || 1;
    const away = [(x - other[0]) / size, (y - other[1]) / size];
    drawRing(pen, x, y, 3.5, colours.paper, colours.ink);
    if (body < 0) drawHatchedGround(pen, makePlacer([x, y], away)(5), away, HALF, colours);
  }
}

/** Draw a joint that neither fixes its point nor leads it along an axis, by its kind. */
const BETWEEN_POINTS = {
  rod: drawRod,
  curve: (pen, joint, from, at, colours) => {
    drawRing(pen, at[0], at[1], DOT, colours.paper, colours.ink, 1.4); // its path is drawn as a line
  },
};

/** The kinds of joints that have a symbol. */
export const DRAWN_KINDS = [AT_POINT, SLIDING, BETWEEN_POINTS].flatMap(Object.keys);

/** Find half of the smallest edge of a body's box [m], about the distance of its face from its middle. */
const findHalfThickness = rememberByObject((body) => {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const { corners, ball } of body.surfaces) {
    const edges = ball ? [-1, 1].flatMap((s) => ball.center.map((c) => c + s * ball.radius)) : corners;
    for (let i = 0; i < edges.length; i += 1) {
      low[i % 3] = Math.min(low[i % 3], edges[i]);
      high[i % 3] = Math.max(high[i % 3], edges[i]);
    }
  }
  return body.surfaces.length ? Math.min(...high.map((h, i) => h - low[i])) / 2 : 0;
});

/**
 * Compute the depth of what joins two bodies [m]: in front of the faces of both.
 * @param {number[][]} places on the screen
 */
export function computeDepth(view, scene, a, b, places) {
  const thick = [a, b].map((k) => (k < 0 ? 0 : findHalfThickness(scene.bodies[k])));
  const middle = places.reduce((sum, place) => sum + place[2], 0) / places.length;
  return middle + Math.min(MAX_OFFSET * view.radius, 1.3 * Math.max(...thick)) + CLEARANCE * view.radius;
}

/** Give the painter a joint. */
export function paintJoint(painter, view, poses, scene, joint, colours, small) {
  const ends = [view.project(locatePoint(poses, joint.a, joint.p)), view.project(locatePoint(poses, joint.b, joint.q))];
  const places = joint.kind in AT_POINT || joint.kind in SLIDING ? ends.slice(1) : ends;
  const near = computeDepth(view, scene, joint.a, joint.b, places);
  painter.add(near, (pen) => drawJoint(pen, view, poses, joint, colours, small));
}

/** Draw a joint. @param {boolean} small whether there are so many that symbols would hide the machine */
function drawJoint(pen, view, poses, joint, colours, small) {
  const from = view.project(locatePoint(poses, joint.a, joint.p)).slice(0, 2);
  const at = view.project(locatePoint(poses, joint.b, joint.q)).slice(0, 2);
  const axis = rotateDirection(poses, joint.a, joint.axis);
  const grounded = joint.a < 0 || joint.b < 0;
  if (small && !grounded) {
    drawRing(pen, at[0], at[1], DOT, colours.paper, colours.ink, 1);
    return;
  }
  if (joint.kind in AT_POINT) {
    if (grounded) drawStand(pen, view, at, colours);
    AT_POINT[joint.kind](pen, at, projectDirection(view, axis), colours);
  } else if (joint.kind in SLIDING) {
    SLIDING[joint.kind](pen, view, at, axis, grounded, colours);
  } else {
    BETWEEN_POINTS[joint.kind](pen, joint, from, at, colours);
  }
}

/** Give the painter a line on the ground: the path of a point, the circle of a ring. */
export function paintPath(painter, view, path, colours) {
  const ends = [];
  for (let i = 0; i < path.length; i += 3) ends.push(view.project(path.subarray(i, i + 3)));
  const near = ends.reduce((sum, end) => sum + end[2], 0) / ends.length;
  painter.add(near, (pen) => drawPolyline(pen, ends, colours.ink, 1.5));
}

/** Draw the world's axes, and gravity beside them. */
export function drawCorner(pen, view, gravity, colours, labels) {
  const [x, y] = [44, view.height - 44];
  const toPixels = (direction) => view.projectVector(direction).map((component) => (CORNER * component) / view.scale);
  ["x", "y", "z"].forEach((name, k) => {
    const [dx, dy] = toPixels([0, 1, 2].map((i) => Number(i === k)));
    drawPolyline(
      pen,
      [
        [x, y],
        [x + dx, y + dy],
      ],
      colours.ink,
      1.6,
    );
    const size = Math.hypot(dx, dy);
    if (size < 6) return;
    const [nx, ny] = makePlacer([x, y], [dx / size, dy / size])(size + 9);
    labels.addFixed(`axis ${name}`, name, nx, ny, colours.ink, 10, "center");
  });
  if (norm(gravity) > 0) {
    const [dx, dy, near] = toPixels(normalize(gravity));
    const from = [x + 62, y - 16];
    drawArrow(pen, from, [from[0] + dx, from[1] + dy], near * view.scale, colours.faint, colours.panel);
    labels.addFixed("g", "g", from[0] + 10, from[1] + 6, colours.faint, 10);
  }
}

/** Draw a point of the ground. */
export function drawGroundPoint(pen, view, at, colours) {
  const place = makePlacer(view.project(at), [1, 0]);
  drawPolyline(pen, [place(-4), place(4)], colours.faint, 1.2);
  drawPolyline(pen, [place(0, -4), place(0, 4)], colours.faint, 1.2);
}
