/** @file Vectors of three numbers, attitudes as unit quaternions w, x, y, z, and the poses of bodies and points at a
 * frame, or between two while the machine plays. */

const MAX_TURN = 0.5; // rad between two frames: beyond it interpolation visibly distorts a mechanism, so it is left out

/** @param {Vector} a @param {Vector} b @returns {Vector} */
export function add(a, b) {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

/** @param {Vector} a @param {Vector} b @returns {Vector} */
export function subtract(a, b) {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

/** @param {Vector} a @param {number} size @returns {Vector} */
export function scale(a, size) {
  return [a[0] * size, a[1] * size, a[2] * size];
}

/** @param {Vector} a @param {Vector} b @returns {number} */
export function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** @param {Vector} a @param {Vector} b @returns {Vector} */
export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** @param {Vector} a @returns {number} */
export function norm(a) {
  return Math.sqrt(dot(a, a));
}

/**
 * Normalize a vector; the zero vector gives the third axis, so that nothing becomes NaN.
 * @param {Vector} a @returns {Vector}
 */
export function normalize(a) {
  const length = norm(a);
  return length > 0 ? scale(a, 1 / length) : [0, 0, 1];
}

/**
 * Make the rotation matrix of an attitude, row by row: from body axes to world axes.
 * @param {number[]} q unit quaternion
 * @returns {number[]} nine numbers
 */
export function makeRotationMatrix([w, x, y, z]) {
  return [
    1 - 2 * (y * y + z * z),
    2 * (x * y - w * z),
    2 * (x * z + w * y),
    2 * (x * y + w * z),
    1 - 2 * (x * x + z * z),
    2 * (y * z - w * x),
    2 * (x * z - w * y),
    2 * (y * z + w * x),
    1 - 2 * (x * x + y * y),
  ];
}

/** Rotate a vector by a matrix. @param {number[]} R @param {Vector} v @returns {Vector} */
export function rotate(R, v) {
  return [
    R[0] * v[0] + R[1] * v[1] + R[2] * v[2],
    R[3] * v[0] + R[4] * v[1] + R[5] * v[2],
    R[6] * v[0] + R[7] * v[1] + R[8] * v[2],
  ];
}

/**
 * Compute the pose of a body.
 * @param {object} body @param {number} frame @param {number} share of the way to the next frame, 0 to 1
 * @returns {Pose}
 */
function computePose(body, frame, share) {
  const p = body.places;
  const a = body.attitudes;
  const i = 3 * frame;
  const j = 4 * frame;
  const place = [p[i], p[i + 1], p[i + 2]];
  const q = [a[j], a[j + 1], a[j + 2], a[j + 3]];
  if (share > 0 && j + 7 < a.length) {
    const near = q[0] * a[j + 4] + q[1] * a[j + 5] + q[2] * a[j + 6] + q[3] * a[j + 7];
    if (Math.abs(near) > Math.cos(MAX_TURN / 2)) {
      for (let k = 0; k < 3; k += 1) place[k] += share * (p[i + 3 + k] - place[k]);
      for (let k = 0; k < 4; k += 1) q[k] += share * (Math.sign(near) * a[j + 4 + k] - q[k]);
      const size = Math.hypot(...q);
      for (let k = 0; k < 4; k += 1) q[k] /= size;
    }
  }
  return { place, R: makeRotationMatrix(q) };
}

/**
 * Compute the poses of all bodies.
 * @param {Scene} scene @param {number} frame @param {number} share @returns {Pose[]}
 */
export function computePoses(scene, frame, share) {
  return scene.bodies.map((body) => computePose(body, frame, share));
}

/**
 * Locate a point of a body in world axes [m].
 * @param {Pose[]} poses @param {number} body its number; -1: the ground @param {number[]} point body axes [m]
 * @returns {number[]}
 */
export function locatePoint(poses, body, point) {
  return body < 0 ? point : add(poses[body].place, rotate(poses[body].R, point));
}

/**
 * Read three numbers from a list that has `width` numbers a frame, interpolated to the instant that is shown.
 * @param {ArrayLike<number>} values @param {number} width @param {number} i where they begin within a frame
 * @param {{frame: number, share: number}} instant
 */
export function interpolatePlace(values, width, i, { frame, share }) {
  return [0, 1, 2].map((k) => {
    const from = values[width * frame + i + k];
    const to = values[width * (frame + 1) + i + k];
    return share > 0 && to !== undefined ? from + share * (to - from) : from;
  });
}

/**
 * Rotate a direction of a body into world axes.
 * @param {Pose[]} poses @param {number} body @param {number[]} direction
 */
export function rotateDirection(poses, body, direction) {
  return body < 0 ? direction : rotate(poses[body].R, direction);
}
