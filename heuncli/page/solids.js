/** @file Bodies: faces of their shapes with light from above left, their edges; bars where a body has no shapes. */

import { SHADES, tints } from "./colours.js";

const LIGHT = [-0.37, 0.56, 0.74];
const BAR = 6; // pixels: how thick a body without shapes is drawn
const BEFORE = 0.004; // of the scene: how much nearer an edge is taken than its face

/**
 * Corners on the screen: right, down [pixels], near [m], one after the other.
 * @param {Float32Array} corners body axes [m] @param {object} pose @param {object} view
 * @returns {Float64Array}
 */
function seen(corners, pose, view) {
  const { place, R } = pose;
  const at = view.project(place);
  const columns = [0, 1, 2].map((k) => view.direct([R[k], R[3 + k], R[6 + k]]));
  const found = new Float64Array(corners.length);
  for (let i = 0; i < corners.length; i += 3) {
    for (let k = 0; k < 3; k += 1) {
      found[i + k] =
        at[k] + columns[0][k] * corners[i] + columns[1][k] * corners[i + 1] + columns[2][k] * corners[i + 2];
    }
  }
  return found;
}

/** How bright a face is, 0 to 1, by three of its corners. @param {Float64Array} c @param {number[]} face */
function brightness(c, face, scale) {
  const [i, j, k] = [3 * face[0], 3 * face[1], 3 * face[2]];
  const a = [c[j] - c[i], c[i + 1] - c[j + 1], scale * (c[j + 2] - c[i + 2])];
  const b = [c[k] - c[i], c[i + 1] - c[k + 1], scale * (c[k + 2] - c[i + 2])];
  const n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const size = Math.hypot(n[0], n[1], n[2]);
  if (size === 0) return 0.5;
  return Math.max(0, (n[0] * LIGHT[0] + n[1] * LIGHT[1] + n[2] * LIGHT[2]) / size);
}

/** The faces of a surface that look at the viewer. */
function paintFaces(painter, surface, pose, view, shades) {
  const c = seen(surface.corners, pose, view);
  const { scale } = view;
  for (const face of surface.faces) {
    const points = new Array(2 * face.length);
    let area = 0;
    let near = 0;
    for (let k = 0; k < face.length; k += 1) {
      const i = 3 * face[k];
      const j = 3 * face[(k + 1) % face.length];
      area += c[i] * c[j + 1] - c[j] * c[i + 1];
      near += c[i + 2];
      points[2 * k] = c[i];
      points[2 * k + 1] = c[i + 1];
    }
    if (area >= 0) continue; // down is positive on a screen: what looks at the viewer goes round the other way
    const bright = Math.round(brightness(c, face, scale) * (SHADES - 1));
    painter.face(near / face.length, points, shades[bright]);
  }
}

/** A polyline of a body, a piece at a time, so that each is hidden by itself. */
function paintPieces(painter, line, pose, view, paint) {
  const c = seen(line, pose, view);
  for (let i = 0; i + 5 < c.length; i += 3) {
    paint((c[i + 2] + c[i + 5]) / 2, [c[i], c[i + 1], c[i + 3], c[i + 4]]);
  }
}

/** All bodies, given to the painter. @param {number} look how opaque faces are, 0 to 1 */
export function paintBodies(painter, scene, poses, view, colours, look) {
  painter.opaque = look;
  const before = BEFORE * view.radius;
  scene.bodies.forEach((body, k) => {
    const { shades, edge, bar } = tints(k, colours.dark);
    for (const surface of body.surfaces) {
      if (look > 0) paintFaces(painter, surface, poses[k], view, shades);
      for (const line of surface.edges) {
        paintPieces(painter, line, poses[k], view, (near, points) => painter.line(near + before, points, edge, 0.9));
      }
    }
    for (const line of body.lines) {
      paintPieces(painter, line, poses[k], view, (near, points) => {
        painter.line(near, points, edge, BAR + 2);
        painter.line(near + before, points, bar, BAR);
      });
      if (line.length === 3) {
        const [x, y, near] = view.project(poses[k].place);
        painter.line(near, [x, y, x, y], edge, 2 * BAR);
      }
    }
  });
}
