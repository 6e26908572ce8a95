/** @file Surfaces of shapes: which faces share a side, and where they meet in an edge. */

const EDGE = 0.8; // cosine of the angle between two faces below which the side between them is an edge

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
