/** @file Symbols of the loads between two points: springs, dampers, actuators, bushings. */

import { locatePoint } from "./poses.js";
import { drawPolyline, drawRing, drawShape } from "./strokes.js";
import { computeDepth, drawStand, makePlacer } from "./symbols.js";

const COILS = 7;

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
