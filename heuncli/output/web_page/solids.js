/** @file Paints bodies: the faces and edges of their shapes, lit from above left; bars where a body has no shapes. */

import { rememberByObject } from "./data.js";
import { locatePoint } from "./poses.js";

const MAX_SMOOTH = 0.8; // cosine of the angle between two faces below which the side between them is an edge
/** Hue [degrees] and saturation [%] of each kind of body, chosen so that the colour-blind can tell them apart. */
const HUES = [
  [205, 45],
  [28, 60],
  [160, 38],
  [325, 35],
  [48, 50],
  [265, 30],
  [190, 20],
  [95, 28],
];
const SHADES = 12;
const LIGHT = [-0.37, 0.56, 0.74]; // direction to the light: right, up, toward the viewer
const BAR = 6; // pixels: how thick a body without shapes is drawn
const ARM = 2; // pixels: lines on a body, and from its shapes to a point that lies off them
const PLATE_OPACITY = 0.45; // how opaque the plate is that is drawn between the points of a body without shapes
const BAR_OFFSET = 0.004; // of the scene: how much nearer a bar is taken than its rim

/** Number the kinds of the bodies: those whose names differ in digits alone are of one kind, and share a colour. */
const numberKinds = rememberByObject((scene) => {
  const known = new Map();
  return scene.bodies.map(({ name }) => {
    const kind = name.replace(/[\d_ .-]+/g, "") || name;
    if (!known.has(kind)) known.set(kind, known.size);
    return known.get(kind);
  });
});

/**
 * Mix the colours of a kind of body: shades from dark to bright, and one for its edges.
 * @param {number} k @param {boolean} dark
 */
function mixTints(k, dark) {
  const [hue, rich] = HUES[k % HUES.length];
  const [low, high] = dark ? [24, 52] : [52, 88];
  const shades = [];
  for (let i = 0; i < SHADES; i += 1) {
    shades.push(`hsl(${hue} ${rich}% ${(low + ((high - low) * i) / (SHADES - 1)).toFixed(1)}%)`);
  }
  return {
    shades,
    edge: `hsl(${hue} ${rich}% ${dark ? 78 : 27}%)`,
    bar: `hsl(${hue} ${rich + 8}% ${dark ? 55 : 58}%)`,
  };
}

/** Compute the unit normal of a face from all of its corners (Newell's method). */
function computeFaceNormal(corners, face) {
  const n = [0, 0, 0];
  for (let k = 0; k < face.length; k += 1) {
    const [i, j] = [3 * face[k], 3 * face[(k + 1) % face.length]];
    for (let a = 0; a < 3; a += 1) {
      const [b, c] = [(a + 1) % 3, (a + 2) % 3];
      n[a] += corners[i + b] * corners[j + c] - corners[i + c] * corners[j + b];
    }
  }
  const size = Math.hypot(...n) || 1;
  return n.map((component) => component / size);
}

/**
 * Find the sides of each face of a surface: where its two corners begin in the list of coordinates, the face beyond it
 * (-1: none), whether it is an edge, and its own face.
 * @type {(surface: Surface) => {i: number, j: number, beyond: number, edge: boolean, face: number}[][]}
 */
const findSides = rememberByObject(({ corners, faces }) => {
  const known = new Map();
  const looks = faces.map((face) => computeFaceNormal(corners, face));
  const key = (i, j) => (i < j ? `${i},${j}` : `${j},${i}`);
  return faces.map((face, f) =>
    face.map((i, k) => {
      const j = face[(k + 1) % face.length];
      const side = { i: 3 * i, j: 3 * j, beyond: -1, edge: true, face: f };
      const other = known.get(key(i, j));
      if (other) {
        const along = looks[f].reduce((sum, c, a) => sum + c * looks[other.face][a], 0);
        other.beyond = f;
        side.beyond = other.face;
        other.edge = side.edge = along < MAX_SMOOTH;
      }
      known.set(key(i, j), side);
      return side;
    }),
  );
});

/**
 * Project corners to the screen: right, down [pixels], near [m], one after the other.
 * @param {Float32Array} corners body axes [m] @param {object} pose @param {object} view
 * @returns {Float64Array}
 */
function projectCorners(corners, pose, view) {
  const { place, R } = pose;
  const at = view.project(place);
  const [a, b, c] = [0, 1, 2].map((k) => view.projectVector([R[k], R[3 + k], R[6 + k]]));
  const found = new Float64Array(corners.length);
  for (let i = 0; i < corners.length; i += 3) {
    const [x, y, z] = [corners[i], corners[i + 1], corners[i + 2]];
    found[i] = at[0] + a[0] * x + b[0] * y + c[0] * z;
    found[i + 1] = at[1] + a[1] * x + b[1] * y + c[1] * z;
    found[i + 2] = at[2] + a[2] * x + b[2] * y + c[2] * z;
  }
  return found;
}

/**
 * Compute the brightness of a face, 0 to 1, from three of its corners.
 * @param {Float64Array} c @param {number[]} face
 */
function computeBrightness(c, face, scale) {
  const [i, j, k] = [3 * face[0], 3 * face[1], 3 * face[2]];
  const a = [c[j] - c[i], c[i + 1] - c[j + 1], scale * (c[j + 2] - c[i + 2])];
  const b = [c[k] - c[i], c[i + 1] - c[k + 1], scale * (c[k + 2] - c[i + 2])];
  const n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const size = Math.hypot(n[0], n[1], n[2]);
  if (size === 0) return 0.5;
  return Math.max(0, (n[0] * LIGHT[0] + n[1] * LIGHT[1] + n[2] * LIGHT[2]) / size);
}

/**
 * Compute twice the area of a face on the screen; negative if it faces the viewer, since the screen's y points down.
 */
function computeScreenArea(c, face) {
  let area = 0;
  for (let k = 0; k < face.length; k += 1) {
    const i = 3 * face[k];
    const j = 3 * face[(k + 1) % face.length];
    area += c[i] * c[j + 1] - c[j] * c[i + 1];
  }
  return area;
}

/** Paint the faces of a surface that face the viewer, with sharp edges and the outline. */
function paintFaces(painter, surface, pose, view, { shades, edge }) {
  const { faces } = surface;
  const sides = findSides(surface);
  const c = projectCorners(surface.corners, pose, view);
  const looks = faces.map((face) => computeScreenArea(c, face) < 0);
  faces.forEach((face, f) => {
    if (!looks[f]) return;
    const points = new Array(2 * face.length);
    let near = 0;
    for (let k = 0; k < face.length; k += 1) {
      const i = 3 * face[k];
      points[2 * k] = c[i];
      points[2 * k + 1] = c[i + 1];
      near += c[i + 2] / face.length;
    }
    const drawn = [];
    for (const { i, j, beyond, edge: sharp } of sides[f]) {
      if (sharp || !looks[beyond]) drawn.push(c[i], c[i + 1], c[j], c[j + 1]);
    }
    const bright = Math.round(computeBrightness(c, face, view.scale) * (SHADES - 1));
    painter.addFace(near, points, shades[bright], drawn, edge, 1);
  });
}

/** Paint a polyline of a body segment by segment, so that each has its own depth. */
function paintPieces(line, pose, view, paint) {
  const c = projectCorners(line, pose, view);
  for (let i = 0; i + 5 < c.length; i += 3) {
    paint((c[i + 2] + c[i + 5]) / 2, [c[i], c[i + 1], c[i + 3], c[i + 4]]);
  }
}

/** Compute the convex hull of points of the screen (Andrew's monotone chain). @param {number[][]} points */
function computeConvexHull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (list) => {
    const found = [];
    for (const p of list) {
      for (;;) {
        const [a, b] = found.slice(-2);
        if (!b || (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        found.pop();
      }
      found.push(p);
    }
    return found.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

/** Paint a body without shapes: bars through its points, a plate between three or more, a dot for one. */
function paintBars(painter, line, pose, view, { edge, bar, shades }) {
  if (line.length > 6) {
    const c = projectCorners(line, pose, view);
    const places = [];
    let near = 0;
    for (let i = 0; i < c.length; i += 3) {
      places.push([c[i], c[i + 1]]);
      near += (3 * c[i + 2]) / c.length;
    }
    painter.addFace(near, computeConvexHull(places).flat(), shades[SHADES - 3], [], edge, PLATE_OPACITY);
  }
  paintPieces(line, pose, view, (near, points) => {
    painter.addLine(near, points, edge, BAR + 2);
    painter.addLine(near + BAR_OFFSET * view.radius, points, bar, BAR);
  });
  if (line.length === 3) {
    const [x, y, near] = projectCorners(line, pose, view);
    painter.addLine(near, [x, y, x, y], edge, 2 * BAR);
  }
}

/** Give the painter all bodies. */
export function paintBodies(painter, scene, poses, view, colours) {
  const kinds = numberKinds(scene);
  const tints = new Map([...new Set(kinds)].map((kind) => [kind, mixTints(kind, colours.dark)]));
  scene.bodies.forEach((body, k) => {
    const own = tints.get(kinds[k]);
    for (const surface of body.surfaces) {
      if (surface.ball) {
        const [x, y, near] = view.project(locatePoint(poses, k, surface.ball.center));
        painter.addBall(near, x, y, surface.ball.radius * view.scale, own.shades, own.edge);
      } else {
        paintFaces(painter, surface, poses[k], view, own);
      }
    }
    const thin = (line) =>
      paintPieces(line, poses[k], view, (near, points) => painter.addLine(near, points, own.edge, ARM));
    for (const bar of body.bars) {
      if (body.surfaces.length === 0) paintBars(painter, bar, poses[k], view, own);
      else thin(bar);
    }
    body.lines.forEach(thin);
  });
}
