/** @file Surfaces of shapes: which faces share a side, where they meet in an edge, and what holds joints off them. */

const EDGE = 0.8; // cosine of the angle between two faces below which the side between them is an edge
const OFF = 0.04; // of the scene: how far off a joint stands from its body's shapes to be told by a line

/** The direction in which a face looks, by all of its corners. */
function outward(corners, face) {
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
 * The sides of each face: its two corners, the face beyond it (-1: none), whether it is an edge. Made once.
 * @param {object} surface @returns {{i: number, j: number, beyond: number, edge: boolean}[][]}
 */
export function sidesOf(surface) {
  if (surface.sides) return surface.sides;
  const { corners, faces } = surface;
  const known = new Map();
  const looks = faces.map((face) => outward(corners, face));
  const key = (i, j) => (i < j ? `${i},${j}` : `${j},${i}`);
  surface.sides = faces.map((face, f) =>
    face.map((i, k) => {
      const j = face[(k + 1) % face.length];
      const side = { i: 3 * i, j: 3 * j, beyond: -1, edge: true, face: f };
      const other = known.get(key(i, j));
      if (other) {
        const along = looks[f].reduce((sum, c, a) => sum + c * looks[other.face][a], 0);
        other.beyond = f;
        side.beyond = other.face;
        other.edge = side.edge = along < EDGE;
      }
      known.set(key(i, j), side);
      return side;
    }),
  );
  return surface.sides;
}

/** Whether a point lies between the extreme corners of a surface. */
function within({ corners, ball }, point) {
  if (ball) return Math.hypot(...ball.center.map((c, k) => c - point[k])) <= ball.radius;
  return [0, 1, 2].every((k) => {
    let [low, high] = [Infinity, -Infinity];
    for (let i = k; i < corners.length; i += 3) {
      low = Math.min(low, corners[i]);
      high = Math.max(high, corners[i]);
    }
    return point[k] >= low && point[k] <= high;
  });
}

/** The places of a surface to which a line may go, body axes. @returns {number[][]} */
function placesOf({ corners, ball }) {
  if (ball) return [ball.center];
  const found = [];
  for (let i = 0; i < corners.length; i += 3) found.push([...corners.subarray(i, i + 3)]);
  return found;
}

/**
 * What holds joints that stand off the shapes of their body: lines to the nearest corners. Made once.
 * @param {object} scene @param {number} k of the body @returns {Float32Array[]}
 */
export function armsOf(scene, k) {
  const body = scene.bodies[k];
  if (body.arms) return body.arms;
  const ends = scene.joints.flatMap((j) => [...(j.a === k ? [j.p] : []), ...(j.b === k ? [j.q] : [])]);
  body.arms = [];
  for (const end of body.surfaces.length ? ends : []) {
    if (body.surfaces.some((surface) => within(surface, end))) continue;
    const apart = (place) => Math.hypot(...place.map((c, a) => c - end[a]));
    const best = body.surfaces.flatMap(placesOf).reduce((a, b) => (apart(b) < apart(a) ? b : a));
    if (apart(best) > OFF * scene.radius) body.arms.push(new Float32Array([...end, ...best]));
  }
  return body.arms;
}
