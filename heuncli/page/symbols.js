/** @file The field's symbols: joints, the ground, springs, ropes; the axes of the world and gravity in the corner. */

import { points, stands } from "./poses.js";
import { arrow, polyline, ring, shape, words } from "./strokes.js";
import { lengthOf, unit } from "./vectors.js";

const R = 5.5; // pixels: radius of a joint
const STAND = 15; // pixels: from a joint to the ground that holds it
const HALF = 12; // pixels: half of the line of ground under a joint
const GUIDE = 0.11; // of the scene: half of a guide's rails
const COILS = 7;

/** The kinds of joints that hold a point, and what their symbol has beside its ring. */
const AT_POINT = { ball: "ball", pin: "pin", universal: "cross", weld: "weld" };

/** A direction on the screen of unit length; one that looks at the viewer has none. */
function onScreen(view, v) {
  const [x, y] = view.direct(unit(v));
  const size = Math.hypot(x, y);
  return size > 0.15 * view.scale ? [x / size, y / size] : null;
}

/** Ground: a line with strokes beyond it; u along it, n away from what stands on it. */
function hatched(pen, [x, y], u, n, half, colours) {
  polyline(pen, [[x - half * u[0], y - half * u[1]], [x + half * u[0], y + half * u[1]]], colours.ink, 1.6);
  for (let t = -half + 3; t <= half; t += 5) {
    const [bx, by] = [x + t * u[0], y + t * u[1]];
    polyline(pen, [[bx, by], [bx + 5 * (n[0] - 0.7 * u[0]), by + 5 * (n[1] - 0.7 * u[1])]], colours.ink, 1);
  }
}

/** A joint that holds a point: with legs where it stands on the ground. */
function atPoint(pen, view, joint, at, axis, grounded, colours) {
  const [x, y] = at;
  if (grounded) {
    const n = onScreen(view, view.up.map((c) => -c)) || [0, 1];
    const u = [-n[1], n[0]];
    const foot = [x + STAND * n[0], y + STAND * n[1]];
    const legs = [-8, 8].map((t) => [foot[0] + t * u[0], foot[1] + t * u[1]]);
    shape(pen, [at, ...legs], colours.paper, colours.ink, 1.4);
    hatched(pen, foot, u, n, HALF, colours);
  }
  const along = joint.kind === "pin" && onScreen(view, axis);
  if (along) {
    const reach = 11;
    polyline(pen, [[x - reach * along[0], y - reach * along[1]], [x + reach * along[0], y + reach * along[1]]], colours.ink, 2);
  }
  if (AT_POINT[joint.kind] === "weld") {
    shape(pen, [[x - 5, y - 5], [x + 5, y - 5], [x + 5, y + 5], [x - 5, y + 5]], colours.ink, colours.paper, 1);
    return;
  }
  ring(pen, x, y, R, colours.paper, colours.ink, 1.8);
  if (joint.kind === "ball") ring(pen, x, y, R - 2.8, colours.ink, colours.ink, 1);
  if (joint.kind === "pin") ring(pen, x, y, 1.2, colours.ink, colours.ink, 1);
  if (joint.kind === "universal") {
    polyline(pen, [[x - R, y], [x + R, y]], colours.ink, 1.5);
    polyline(pen, [[x, y - R], [x, y + R]], colours.ink, 1.5);
  }
}

/** Two rails along a direction at both sides of a place, hatched where they are the ground. */
function rails(pen, view, at, axis, grounded, colours, sides) {
  const u = onScreen(view, axis);
  if (!u) return;
  const n = [-u[1], u[0]];
  const flipped = n[1] < 0 ? [-n[0], -n[1]] : n;
  const half = Math.max(16, Math.min(60, GUIDE * view.radius * Math.hypot(...view.direct(unit(axis)).slice(0, 2))));
  for (const side of sides) {
    const foot = [at[0] + side * flipped[0], at[1] + side * flipped[1]];
    const ends = [-half, half].map((t) => [foot[0] + t * u[0], foot[1] + t * u[1]]);
    polyline(pen, ends, colours.ink, 1.5);
    if (grounded && side === sides[0]) hatched(pen, foot, u, flipped, half, colours);
  }
}

/** What slides: a block between rails, on a line that is dashed from where it is counted. */
function sliding(pen, view, joint, from, at, axis, grounded, colours) {
  const u = onScreen(view, axis) || [1, 0];
  const n = [-u[1], u[0]];
  polyline(pen, [from.slice(0, 2), at.slice(0, 2)], colours.faint, 1, [5, 4]);
  if (joint.kind === "line" || joint.kind === "plane") {
    const across = joint.kind === "plane" ? [n[0], n[1]] : u;
    const along = joint.kind === "plane" ? planeLine(view, axis) : axis;
    if (along) rails(pen, view, at, along, grounded, colours, joint.kind === "plane" ? [R + 2] : [R + 2, -R - 2]);
    ring(pen, at[0], at[1], R, colours.paper, colours.ink, 1.8);
    polyline(pen, [[at[0] - 2 * across[0], at[1] - 2 * across[1]], [at[0] + 2 * across[0], at[1] + 2 * across[1]]], colours.ink, 1.5);
    return;
  }
  rails(pen, view, at, axis, grounded, colours, [9, -9]);
  const corner = (a, b) => [at[0] + a * u[0] + b * n[0], at[1] + a * u[1] + b * n[1]];
  shape(pen, [corner(-10, -6), corner(10, -6), corner(10, 6), corner(-10, 6)], colours.paper, colours.ink, 1.8);
  if (joint.kind === "cylinder") ring(pen, at[0], at[1], 3, colours.paper, colours.ink, 1.4);
}

/** A direction in a plane that lies across the screen, by its normal. */
function planeLine(view, normal) {
  const v = [0, 1, 2].map((i) => normal[(i + 1) % 3] * view.toward[(i + 2) % 3] - normal[(i + 2) % 3] * view.toward[(i + 1) % 3]);
  return lengthOf(v) > 0.1 ? v : null;
}

/** A joint. */
export function drawJoint(pen, view, poses, joint, colours) {
  const from = view.project(stands(poses, joint.a, joint.p));
  const at = view.project(stands(poses, joint.b, joint.q));
  const axis = points(poses, joint.a, joint.axis);
  const grounded = joint.a < 0 || joint.b < 0;
  if (joint.kind === "rod") {
    polyline(pen, [from, at], colours.ink, 2, joint.rope ? [8, 3] : []);
    ring(pen, from[0], from[1], 3.5, colours.paper, colours.ink);
    ring(pen, at[0], at[1], 3.5, colours.paper, colours.ink);
    if (grounded) {
      const held = joint.a < 0 ? from : at;
      const other = joint.a < 0 ? at : from;
      const size = Math.hypot(other[0] - held[0], other[1] - held[1]) || 1;
      const n = [(held[0] - other[0]) / size, (held[1] - other[1]) / size];
      hatched(pen, [held[0] + 5 * n[0], held[1] + 5 * n[1]], [-n[1], n[0]], n, HALF, colours);
    }
  } else if (joint.kind in AT_POINT) {
    atPoint(pen, view, joint, at.slice(0, 2), axis, grounded, colours);
  } else {
    sliding(pen, view, joint, from, at, axis, grounded, colours);
  }
}

/** A spring as a zigzag, an actuator as a cylinder with its rod. */
export function drawLine(pen, view, poses, line, colours) {
  const a = view.project(stands(poses, line.a, line.p));
  const b = view.project(stands(poses, line.b, line.q));
  const at = (t, side = 0) => {
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    const size = Math.hypot(dx, dy) || 1;
    return [a[0] + t * dx - (side * dy) / size, a[1] + t * dy + (side * dx) / size];
  };
  if (line.kind === "spring") {
    const turns = [];
    for (let k = 0; k < 2 * COILS; k += 1) turns.push(at(0.15 + (0.7 * (k + 0.5)) / (2 * COILS), k % 2 ? 6 : -6));
    polyline(pen, [at(0), at(0.15), ...turns, at(0.85), at(1)], colours.ink, 1.5);
  } else {
    polyline(pen, [at(0), at(1)], colours.ink, 1.8);
    shape(pen, [at(0.12, 5), at(0.58, 5), at(0.58, -5), at(0.12, -5)], colours.paper, colours.ink, 1.5);
    polyline(pen, [at(0.45, 5), at(0.45, -5)], colours.ink, 1.5);
  }
  for (const [x, y] of [a, b]) ring(pen, x, y, 2.5, colours.ink, colours.ink, 1);
}

/** The axes of the world, and gravity beside them. */
export function drawCorner(pen, view, gravity, colours) {
  const [x, y] = [44, view.height - 44];
  ["x", "y", "z"].forEach((name, k) => {
    const axis = [0, 1, 2].map((i) => (i === k ? 1 : 0));
    const [dx, dy] = view.direct(axis).map((c) => (30 * c) / view.scale);
    polyline(pen, [[x, y], [x + dx, y + dy]], colours.ink, 1.6);
    const size = Math.hypot(dx, dy) || 1;
    if (size > 6) words(pen, name, x + dx * (1 + 9 / size), y + dy * (1 + 9 / size), colours.ink, colours.panel, "center");
  });
  if (lengthOf(gravity) > 0) {
    const [dx, dy, near] = view.direct(unit(gravity)).map((c) => (30 * c) / view.scale);
    const from = [x + 62, y - 16];
    arrow(pen, from, [from[0] + dx, from[1] + dy], near * view.scale, colours.faint, colours.panel);
    words(pen, "g", from[0] + 10, from[1] + 6, colours.faint, colours.panel);
  }
}

/** A point of the ground. */
export function drawGroundPoint(pen, view, at, colours) {
  const [x, y] = view.project(at);
  polyline(pen, [[x - 4, y], [x + 4, y]], colours.faint, 1.2);
  polyline(pen, [[x, y - 4], [x, y + 4]], colours.faint, 1.2);
}
