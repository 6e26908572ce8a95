/** @file Belts and ropes: straight strands between pulleys, and arcs on them. */

import { interpolatePlace, rotateDirection, locatePoint } from "./poses.js";
import { drawPolyline } from "./strokes.js";
import { cross, dot, subtract, add, scale } from "./vectors.js";

const ARC_STEP = 0.1; // rad: an arc is drawn as chords of at most this angle
const WIDTH = 2; // pixels

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

