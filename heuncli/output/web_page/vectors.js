/** @file Vectors of three numbers, world or body axes; attitudes as unit quaternions w, x, y, z. */

/** @typedef {number[]} Vector */

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
