/** @file The field's symbols: joints, the ground, springs, ropes; the axes of the world and gravity in the corner. */

import { points, locatePoint } from "./poses.js";
import { arrow, polyline, ring, shape } from "./strokes.js";
import { cross, lengthOf, unit } from "./vectors.js";

const R = 5.5; // pixels: radius of a joint
const DOT = 2; // pixels: radius of one of many joints
const STAND = 15; // pixels: from a joint to the ground that holds it
const HALF = 12; // pixels: half of the line of ground under a joint
const GUIDE = 0.11; // of the scene: half of a guide's rails
const COILS = 7;
const BEFORE = 0.3; // of the scene's radius: a symbol is drawn before no body that is nearer than that
const CLEAR = 0.01; // of the scene's radius, beyond the face
const CORNER = 30; // pixels: length of the axes of the world

/** A direction on the screen of unit length; one that looks at the viewer has none. */
function onScreen(view, v) {
  const [x, y] = view.direct(unit(v));
  const size = Math.hypot(x, y);
  return size > 0.15 * view.scale ? [x / size, y / size] : null;
}

/** Places about one on the screen: so many pixels along a direction, and so many to its right as one looks along it. */
function placer([x, y], [ux, uy]) {
  return (along, aside = 0) => [x + along * ux - aside * uy, y + along * uy + aside * ux];
}

/** Ground: a line through a place with strokes beyond it; n: away from what stands on it. */
function hatched(pen, at, n, half, colours) {
  const place = placer(at, n);
  polyline(pen, [place(0, -half), place(0, half)], colours.ink, 1.6);
  for (let t = -half + 3; t <= half; t += 5) polyline(pen, [place(0, t), place(5, t - 3.5)], colours.ink, 1);
}

/** Legs from a joint to the ground that holds it. */
function drawStand(pen, view, at, colours) {
  const down = view.up.map((component) => -component);
  const n = onScreen(view, down) ?? [0, 1];
  const place = placer(at, n);
  shape(pen, [at, place(STAND, -8), place(STAND, 8)], colours.paper, colours.ink, 1.4);
  hatched(pen, place(STAND), n, HALF, colours);
}

/** What a joint that holds a point is drawn as, by its kind, at a place; along: its axis on the screen, if seen. */
const AT_POINT = {
  ball: (pen, [x, y], along, colours) => {
    ring(pen, x, y, R, colours.paper, colours.ink, 1.8);
    ring(pen, x, y, R - 2.8, colours.ink, colours.ink, 1);
  },
  pin: (pen, [x, y], along, colours) => {
    const place = along && placer([x, y], along);
    if (place) polyline(pen, [place(-2 * R), place(2 * R)], colours.ink, 2);
    ring(pen, x, y, R, colours.paper, colours.ink, 1.8);
    ring(pen, x, y, 1.2, colours.ink, colours.ink, 1);
  },
  universal: (pen, [x, y], along, colours) => {
    const place = placer([x, y], along ?? [1, 0]);
    ring(pen, x, y, R, colours.paper, colours.ink, 1.8);
    polyline(pen, [place(-R), place(R)], colours.ink, 1.5);
    polyline(pen, [place(0, -R), place(0, R)], colours.ink, 1.5);
  },
  cv: (pen, at, along, colours) => {
    ring(pen, ...at, R, colours.paper, colours.ink, 1.8);
    const place = placer(at, [1, 0]);
    for (const [x, y] of [[0, -R], [0.87 * R, 0.5 * R], [-0.87 * R, 0.5 * R]]) {
      polyline(pen, [at, place(x, y)], colours.ink, 1.5);
    }
  },
  weld: (pen, at, along, colours) => {
    const place = placer(at, [1, 0]);
    shape(pen, [place(-5, -5), place(5, -5), place(5, 5), place(-5, 5)], colours.ink, colours.paper, 1);
  },
};

/** Rails along a world direction beside a place, the first of them hatched where it is the ground. */
function rails(pen, view, at, along, grounded, colours, sides) {
  const u = onScreen(view, along);
  if (!u) return;
  const n = u[0] >= 0 ? u : [-u[0], -u[1]]; // so that the ground is below
  const place = placer(at, n);
  const half = Math.max(16, Math.min(60, GUIDE * view.radius * view.scale));
  sides.forEach((side, k) => {
    polyline(pen, [place(-half, side), place(half, side)], colours.ink, 1.5);
    if (grounded && k === 0) hatched(pen, place(0, side), [-n[1], n[0]], half, colours);
  });
}

/** A block between rails. */
function block(pen, view, at, axis, grounded, colours) {
  const place = placer(at, onScreen(view, axis) ?? [1, 0]);
  rails(pen, view, at, axis, grounded, colours, [9, -9]);
  shape(pen, [place(-10, -6), place(10, -6), place(10, 6), place(-10, 6)], colours.paper, colours.ink, 1.8);
}

/** A roller on rails. */
function roller(pen, view, at, along, grounded, colours, sides) {
  if (lengthOf(along) > 0.1) rails(pen, view, at, along, grounded, colours, sides);
  ring(pen, at[0], at[1], R, colours.paper, colours.ink, 1.8);
  ring(pen, at[0], at[1], 1.2, colours.ink, colours.ink, 1);
}

/** What a joint that leaves a point free to slide is drawn as, by its kind. */
const SLIDING = {
  slide: block,
  cylinder: (pen, view, at, axis, grounded, colours) => {
    block(pen, view, at, axis, grounded, colours);
    ring(pen, at[0], at[1], 3, colours.paper, colours.ink, 1.4);
  },
  line: (pen, view, at, axis, grounded, colours) => {
    roller(pen, view, at, axis, grounded, colours, [R + 2, -R - 2]);
  },
  plane: (pen, view, at, normal, grounded, colours) => {
    roller(pen, view, at, cross(normal, view.toward), grounded, colours, [R + 2]);
  },
};

/** A bar or rope between two points. */
function drawRod(pen, joint, from, at, colours) {
  polyline(pen, [from, at], colours.ink, 2, []);
  for (const [[x, y], other, body] of [
    [from, at, joint.a],
    [at, from, joint.b],
  ]) {
    const size = Math.hypot(x - other[0], y - other[1]) || 1;
    const away = [(x - other[0]) / size, (y - other[1]) / size];
    ring(pen, x, y, 3.5, colours.paper, colours.ink);
    if (body < 0) hatched(pen, placer([x, y], away)(5), away, HALF, colours);
  }
}

/** Half of the smallest edge of a body's box [m]: so far before its middle its face is. Made once. */
function halfThickness(body) {
  if (body.thickness === undefined) {
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (const { corners, ball } of body.surfaces) {
      const edges = ball ? [-1, 1].flatMap((s) => ball.center.map((c) => c + s * ball.radius)) : corners;
      for (let i = 0; i < edges.length; i += 1) {
        low[i % 3] = Math.min(low[i % 3], edges[i]);
        high[i % 3] = Math.max(high[i % 3], edges[i]);
      }
    }
    body.thickness = body.surfaces.length ? Math.min(...high.map((h, i) => h - low[i])) / 2 : 0;
  }
  return body.thickness;
}

/** How near what joins two bodies is drawn [m]: before the faces of both. @param {number[][]} places on the screen */
function nearOf(view, scene, a, b, places) {
  const thick = [a, b].map((k) => (k < 0 ? 0 : halfThickness(scene.bodies[k])));
  const middle = places.reduce((sum, place) => sum + place[2], 0) / places.length;
  return middle + Math.min(BEFORE * view.radius, 1.3 * Math.max(...thick)) + CLEAR * view.radius;
}

/** A joint, given to the painter. */
export function paintJoint(painter, view, poses, scene, joint, colours, small) {
  const ends = [view.project(locatePoint(poses, joint.a, joint.p)), view.project(locatePoint(poses, joint.b, joint.q))];
  const places = joint.kind in AT_POINT || joint.kind in SLIDING ? ends.slice(1) : ends;
  const near = nearOf(view, scene, joint.a, joint.b, places);
  painter.add(near, (pen) => drawJoint(pen, view, poses, joint, colours, small));
}

/** A load between two points, given to the painter. */
export function paintLine(painter, view, poses, scene, line, colours) {
  const ends = [view.project(locatePoint(poses, line.a, line.p)), view.project(locatePoint(poses, line.b, line.q))];
  painter.add(nearOf(view, scene, line.a, line.b, ends), (pen) => drawLine(pen, view, poses, line, colours));
}

/** A joint. @param {boolean} small whether there are so many that symbols would hide the machine */
function drawJoint(pen, view, poses, joint, colours, small) {
  const from = view.project(locatePoint(poses, joint.a, joint.p)).slice(0, 2);
  const at = view.project(locatePoint(poses, joint.b, joint.q)).slice(0, 2);
  const axis = points(poses, joint.a, joint.axis);
  const grounded = joint.a < 0 || joint.b < 0;
  if (small && !grounded) {
    ring(pen, at[0], at[1], DOT, colours.paper, colours.ink, 1);
    return;
  }
  if (joint.kind in AT_POINT) {
    if (grounded) drawStand(pen, view, at, colours);
    AT_POINT[joint.kind](pen, at, onScreen(view, axis), colours);
  } else if (joint.kind in SLIDING) {
    SLIDING[joint.kind](pen, view, at, axis, grounded, colours);
  } else if (joint.kind === "curve") {
    ring(pen, at[0], at[1], DOT, colours.paper, colours.ink, 1.4); // its path is drawn as a line
  } else {
    drawRod(pen, joint, from, at, colours);
  }
}

/** A bushing: two sleeves about its `to` point, and between them what gives way. */
function drawBushing(pen, view, line, a, b, colours) {
  polyline(pen, [a, b], colours.ink, 1);
  if (line.a < 0 || line.b < 0) drawStand(pen, view, line.a < 0 ? a : b, colours);
  ring(pen, b[0], b[1], 9, colours.paper, colours.ink, 1.8);
  for (let k = 0; k < 6; k += 1) {
    const [x, y] = [Math.cos((k * Math.PI) / 3), Math.sin((k * Math.PI) / 3)];
    polyline(
      pen,
      [
        [b[0] + 4 * x, b[1] + 4 * y],
        [b[0] + 8.4 * x, b[1] + 8.4 * y],
      ],
      colours.ink,
      1.2,
    );
  }
  ring(pen, b[0], b[1], 3.4, colours.paper, colours.ink, 1.8);
}

/** The zigzag of a spring, beside the line between its ends. */
function coil(pen, at, aside, wide, colours) {
  const turns = [];
  for (let k = 0; k < 2 * COILS; k += 1) {
    turns.push(at(0.15 + (0.7 * (k + 0.5)) / (2 * COILS), aside + (k % 2 ? wide : -wide)));
  }
  polyline(pen, [at(0), at(0.12), at(0.15, aside), ...turns, at(0.85, aside), at(0.88), at(1)], colours.ink, 1.5);
}

/** The cup and the plate of a damper. */
function dashpot(pen, at, aside, colours) {
  polyline(pen, [at(0.12), at(0.12, aside), at(0.4, aside)], colours.ink, 1.5);
  polyline(pen, [at(0.62, aside + 5), at(0.4, aside + 5), at(0.4, aside - 5), at(0.62, aside - 5)], colours.ink, 1.5);
  polyline(pen, [at(0.55, aside + 3.5), at(0.55, aside - 3.5)], colours.ink, 1.8);
  polyline(pen, [at(0.55, aside), at(0.88, aside), at(0.88)], colours.ink, 1.5);
}

/** By symbol of the kinds of loads (base/load_kinds.py): between two points, at(share, aside) of the way. */
const LINES = {
  spring: (pen, at, colours) => coil(pen, at, 0, 6, colours),
  "damped spring": (pen, at, colours) => {
    coil(pen, at, -8, 5, colours);
    dashpot(pen, at, 8, colours);
  },
  actuator: (pen, at, colours) => {
    polyline(pen, [at(0), at(1)], colours.ink, 1.8);
    shape(pen, [at(0.12, 5), at(0.58, 5), at(0.58, -5), at(0.12, -5)], colours.paper, colours.ink, 1.5);
    polyline(pen, [at(0.45, 5), at(0.45, -5)], colours.ink, 1.5);
  },
};

/** A load between two points by its symbol, a bushing as two sleeves. */
function drawLine(pen, view, poses, line, colours) {
  const a = view.project(locatePoint(poses, line.a, line.p));
  const b = view.project(locatePoint(poses, line.b, line.q));
  if (line.kind === "bushing") {
    drawBushing(pen, view, line, a.slice(0, 2), b.slice(0, 2), colours);
    return;
  }
  const long = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
  const place = placer(a, [(b[0] - a[0]) / long, (b[1] - a[1]) / long]);
  LINES[line.kind](pen, (share, aside = 0) => place(share * long, aside), colours);
  for (const [x, y] of [a, b]) ring(pen, x, y, 2.5, colours.paper, colours.ink, 1.3);
}

/** A line on the ground: a path along which a point runs, the circle of a ring. */
export function paintPath(painter, view, path, colours) {
  const ends = [];
  for (let i = 0; i < path.length; i += 3) ends.push(view.project(path.subarray(i, i + 3)));
  const near = ends.reduce((sum, end) => sum + end[2], 0) / ends.length;
  painter.add(near, (pen) => polyline(pen, ends, colours.ink, 1.5));
}

/** The axes of the world, and gravity beside them. */
export function drawCorner(pen, view, gravity, colours, labels) {
  const [x, y] = [44, view.height - 44];
  const toPixels = (direction) => view.direct(direction).map((component) => (CORNER * component) / view.scale);
  ["x", "y", "z"].forEach((name, k) => {
    const [dx, dy] = toPixels([0, 1, 2].map((i) => Number(i === k)));
    polyline(
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
    const [nx, ny] = placer([x, y], [dx / size, dy / size])(size + 9);
    labels.set(`axis ${name}`, name, nx, ny, colours.ink, 10, "center");
  });
  if (lengthOf(gravity) > 0) {
    const [dx, dy, near] = toPixels(unit(gravity));
    const from = [x + 62, y - 16];
    arrow(pen, from, [from[0] + dx, from[1] + dy], near * view.scale, colours.faint, colours.panel);
    labels.set("g", "g", from[0] + 10, from[1] + 6, colours.faint, 10);
  }
}

/** A point of the ground. */
export function drawGroundPoint(pen, view, at, colours) {
  const place = placer(view.project(at), [1, 0]);
  polyline(pen, [place(-4), place(4)], colours.faint, 1.2);
  polyline(pen, [place(0, -4), place(0, 4)], colours.faint, 1.2);
}
