/** @file Belts and ropes, as full lines; symbols: stops, latches, the ground, what acts in joints. */

import { points, locatePoint } from "./poses.js";
import { polyline, shape } from "./strokes.js";
import { cross, dot, minus, plus, times, unit } from "./vectors.js";

const STEP = 0.1; // rad: of an arc as it is drawn
const WIDTH = 2;
const SIDE = 0.2; // of a direction that is seen: what shows less of it has no side on the screen

/** A number of a list, or between those of two frames. */
function between(values, width, i, { frame, share }) {
  const from = values[width * frame + i];
  const to = values[width * (frame + 1) + i];
  return share > 0 && to !== undefined ? from + share * (to - from) : from;
}

/** Three of them. */
function placeOf(values, width, i, shown) {
  return [0, 1, 2].map((k) => between(values, width, i + k, shown));
}

/** A line through world places, given to the painter as nearly as its middle is. */
function paintStrand(painter, view, line, colours) {
  const seen = line.map((place) => view.project(place));
  const near = seen.reduce((sum, place) => sum + place[2], 0) / seen.length;
  painter.add(near, (pen) => polyline(pen, seen, colours.ink, WIDTH));
}

/** A belt: its strands in the axes of what carries its pulleys. */
export function paintBelt(painter, view, poses, { body, strands }, colours) {
  for (let i = 0; i < strands.length; i += 6) {
    paintStrand(painter, view, [i, i + 3].map((k) => locatePoint(poses, body, strands.subarray(k, k + 3))), colours);
  }
}

/** From one place to another round an axis through a centre, counter-clockwise about it. */
function arc(center, axis, start, end) {
  const r = minus(start, center);
  const to = minus(end, center);
  const turn = Math.atan2(dot(axis, cross(r, to)), dot(r, to));
  const angle = turn < 0 ? turn + 2 * Math.PI : turn;
  const steps = Math.max(1, Math.ceil(angle / STEP));
  const aside = cross(axis, r);
  const found = [];
  for (let k = 0; k <= steps; k += 1) {
    const a = (angle * k) / steps;
    found.push(plus(center, plus(times(r, Math.cos(a)), times(aside, Math.sin(a)))));
  }
  return found;
}

/** A rope: its strands and arcs from end to end. */
export function paintRope(painter, view, poses, rope, shown, colours) {
  const width = 6 * rope.count;
  const ends = [];
  for (let i = 0; i < width; i += 3) ends.push(placeOf(rope.ends, width, i, shown));
  const arcs = new Map(rope.arcs.map((each) => [each.before, each]));
  for (let k = 0; k < rope.count; k += 1) {
    paintStrand(painter, view, [ends[2 * k], ends[2 * k + 1]], colours);
    const lies = arcs.get(k);
    if (!lies) continue;
    const center = locatePoint(poses, lies.body, lies.center);
    const axis = points(poses, lies.along, lies.axis);
    paintStrand(painter, view, arc(center, axis, ends[2 * k + 1], ends[2 * k + 2]), colours);
  }
}

/** When a mark is looked at: one that stands still is told once. */
const whenOf = (mark, shown) => (mark.places.length > 3 ? shown : { frame: 0, share: 0 });

/** A symbol about a place on the screen, its x along a direction there, of unit length. */
function drawSymbol(pen, parts, [x, y], [u, v], colours) {
  for (const part of parts) {
    const corners = part.points.map(([p, q]) => [x + p * u + q * v, y + p * v - q * u]);
    if (part.closed) shape(pen, corners, part.fill ? colours[part.fill] : "transparent", colours.ink, 1.3);
    else polyline(pen, corners, colours.ink, 1.3);
  }
}

/** A mark at its place, its symbol's x along its direction; none where that points at the eye. */
export function drawMark(pen, view, parts, mark, shown, colours) {
  const at = whenOf(mark, shown);
  const [a, b] = view.direct(unit(placeOf(mark.ways, 3, 0, at)));
  const size = Math.hypot(a, b);
  if (size > SIDE * view.scale)
    drawSymbol(pen, parts, view.project(placeOf(mark.places, 3, 0, at)), [a / size, b / size], colours);
}

/** What acts in a joint, or drives it: which way it turns is seen from the side that its axis points to. */
export function drawActing(pen, view, poses, scene, own, colours) {
  const joint = scene.joints[own.joint];
  if (joint.kind === "curve") return; // whose direction is that of its path where the point is
  const [a, b, near] = view.direct(unit(points(poses, joint.a, joint.axis)));
  const size = Math.hypot(a, b);
  const along = own.slides && size > SIDE * view.scale ? [a / size, b / size] : [1, 0];
  const at = view.project(locatePoint(poses, joint.b, joint.q));
  drawSymbol(pen, scene.symbols[own.symbols[near < 0 ? 1 : 0]], at, along, colours);
}

/** The name of a mark that has one, beside it. */
export function nameMark(labels, view, mark, shown, colours) {
  if (!mark.name) return;
  const [x, y] = view.project(placeOf(mark.places, 3, 0, whenOf(mark, shown)));
  labels.add(`mark ${mark.name} ${mark.symbol}`, mark.name, x, y, colours.faint, 1, 10);
}
