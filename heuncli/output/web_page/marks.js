/** @file Marks of the scene: stops, latches, the ground, and what acts in a joint or drives it. */

import { interpolatePlace, rotateDirection, locatePoint } from "./poses.js";
import { drawPolyline, drawShape } from "./strokes.js";
import { normalize } from "./vectors.js";

const MIN_VISIBLE = 0.2; // share of a direction that the view must show, else its side on the screen is arbitrary
const LINE_WIDTH = 1.3;

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
