/** @file From where the machine is seen: a direction, a scale, a shift; parallel projection. */

import { cross, dot, unit } from "./vectors.js";

const STEEPEST = Math.PI / 2;
const NEAREST = 400;
const ROOM = 0.14; // of the canvas: for words and arrows beside the machine
const CORNER = 26; // pixels: kept free below, for axes and scales
const LEAST = 0.02; // of the scene's radius: what is thinner is not seen larger
const HIDING = 0.01; // of the scene's radius cubed: bodies before the joints that weigh more are looked at from behind
const DEEP = 0.6; // of the extent in its plane: a deeper machine is seen from aside (as in heun plot scene)
const FARTHEST = 0.1;
const MIDDLE = 0.02; // of the scene's radius: joints that stand no farther off its middle are in it

/** The world axis nearest to a direction. @param {number[]} v @returns {number[]} */
function nearestAxis(v) {
  const k = [0, 1, 2].reduce((best, i) => (Math.abs(v[i]) > Math.abs(v[best]) ? i : best), 2);
  return [0, 1, 2].map((i) => (i === k ? Math.sign(v[k]) || 1 : 0));
}

/** On which side of the machine most joints stand: 1 that of its normal, -1 the other, 0 neither. */
function sideOf(scene, normal) {
  const places = [...scene.ground.map((point) => point.at), ...scene.joints.filter((j) => j.a < 0).map((j) => j.p)];
  const off = places.reduce((sum, at) => sum + dot(at, normal), 0) / (places.length || 1) - dot(scene.center, normal);
  return places.length > 0 && Math.abs(off) > MIDDLE * scene.radius ? Math.sign(off) : 0;
}

/** The view: up stays up on the screen; azimuth and elevation [rad] tell from where one looks. */
export class View {
  /** @param {object} scene */
  constructor(scene) {
    this.center = scene.center;
    this.radius = scene.radius;
    this.up = nearestAxis(scene.gravity.some((g) => g !== 0) ? scene.gravity.map((g) => -g) : [0, 0, 1]);
    const normal = scene.normal && nearestAxis(scene.normal);
    if (!scene.gravity.some((g) => g !== 0) && normal && Math.abs(normal[2]) === 1) this.up = [0, 1, 0];
    const k = this.up.findIndex((u) => u !== 0);
    const axis = (i) => [0, 1, 2].map((j) => (j === (k + i) % 3 ? 1 : 0));
    [this.first, this.second] = this.up[k] > 0 ? [axis(1), axis(2)] : [axis(2), axis(1)];
    this.normal = normal;
    this.cloud = scene.cloud;
    this.cover = scene.cover;
    this.side = normal ? sideOf(scene, normal) : 0;
    this.width = 100;
    this.height = 100;
    this.begin();
  }

  /** As at the start: along the normal of the plane in which the machine moves, unless it is too deep for that. */
  begin() {
    if (this.normal && !this.deep()) {
      this.along(this.normal.map(Math.abs));
      if (this.cover && this.cover(this.toward) > HIDING * this.radius ** 3) this.turn(Math.PI, 0);
      this.fit();
    } else {
      this.oblique();
    }
  }

  /** As another view, of the same machine in another load case. @param {View} other */
  take({ azimuth, elevation, fitted, zoom, shift, width, height }) {
    Object.assign(this, { azimuth, elevation });
    this.turn(0, 0);
    this.fit();
    if (!fitted) Object.assign(this, { fitted, zoom, shift, width, height });
  }

  /** From aside and above. */
  oblique() {
    if (this.normal && Math.abs(dot(this.normal, this.up)) < 0.5) {
      this.along(this.normal.map(Math.abs));
      if (this.side * dot(this.normal, this.toward) < 0) this.turn(Math.PI, 0);
      this.turn(-0.4, 0.28);
    } else {
      this.azimuth = -1.05;
      this.elevation = this.normal ? 1 : 0.36;
      this.turn(0, 0);
    }
    this.fit();
  }

  /** Whether the machine goes far along the normal of its plane, as an engine of several cylinders does. */
  deep() {
    const span = (v) => this.range(v)[1] - this.range(v)[0];
    const across = [0, 1, 2].filter((i) => !this.normal[i]).map((i) => span([0, 1, 2].map((j) => Number(i === j))));
    return span(this.normal) > DEEP * Math.max(...across);
  }

  /** From where to where the machine goes along a direction, from its middle [m]. @param {number[]} v */
  range(v) {
    let [low, high] = [Infinity, -Infinity];
    for (const p of this.cloud) {
      const at = dot(p, v);
      if (at < low) low = at;
      if (at > high) high = at;
    }
    const middle = dot(this.center, v);
    return [low - middle, high - middle];
  }

  /** On a canvas of this size [pixels]: all of the machine is kept on it until somebody zooms or shifts. */
  fill(width, height) {
    if (width === this.width && height === this.height) return;
    Object.assign(this, { width, height });
    if (this.fitted) this.fit();
  }

  /** All of the machine at all frames within the screen, in the middle, with room for words about it. */
  fit() {
    this.fits = (this.fits ?? 0) + 1;
    this.fitted = true;
    const [left, right] = this.range(this.right);
    const [low, high] = this.range(this.above);
    const least = LEAST * this.radius;
    const across = (this.width * (1 - ROOM)) / Math.max(right - left, least);
    const up = (this.height * (1 - ROOM) - CORNER) / Math.max(high - low, least);
    this.zoom = 1;
    this.zoom = Math.min(NEAREST, Math.max(FARTHEST, Math.min(across, up) / this.scale));
    this.shift = [(-this.scale * (left + right)) / 2, (this.scale * (low + high)) / 2 - CORNER / 2];
  }

  /** Seen along a world axis, so that the axes to the right and up are positive. @param {number[]} axis */
  along(axis) {
    const level = Math.abs(dot(axis, this.up)) < 0.5;
    const right = level ? cross(this.up, axis) : null;
    const toward = right && right.some((r) => r < 0) ? axis.map((c) => -c) : axis;
    this.elevation = level ? 0 : STEEPEST;
    this.azimuth = level ? Math.atan2(dot(toward, this.second), dot(toward, this.first)) : -Math.PI / 2;
    this.turn(0, 0);
  }

  /** Turned on. @param {number} aside [rad] @param {number} up [rad] */
  turn(aside, up) {
    this.azimuth += aside;
    this.elevation = Math.min(STEEPEST, Math.max(-STEEPEST, this.elevation + up));
    const [c, s] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    this.toward = [0, 1, 2].map((i) => ce * (c * this.first[i] + s * this.second[i]) + se * this.up[i]);
    this.right = [0, 1, 2].map((i) => -s * this.first[i] + c * this.second[i]);
    this.above = unit(cross(this.toward, this.right));
  }

  /** Nearer by a factor, about a place on the screen [pixels]. */
  magnify(factor, x = this.width / 2, y = this.height / 2) {
    const zoom = Math.min(NEAREST, Math.max(FARTHEST, this.zoom * factor));
    const real = zoom / this.zoom;
    this.fitted = false;
    this.zoom = zoom;
    const [cx, cy] = [x - this.width / 2, y - this.height / 2];
    this.shift = [cx + (this.shift[0] - cx) * real, cy + (this.shift[1] - cy) * real];
  }

  /** Shifted on the screen [pixels]. */
  move(x, y) {
    this.fitted = false;
    this.shift = [this.shift[0] + x, this.shift[1] + y];
  }

  /** Pixels of a metre. */
  get scale() {
    return (0.43 * Math.min(this.width, this.height) * this.zoom) / this.radius;
  }

  /** A world point on the screen: right, down [pixels], and how near it is [m]. @param {number[]} p */
  project(p) {
    const d = [p[0] - this.center[0], p[1] - this.center[1], p[2] - this.center[2]];
    const s = this.scale;
    return [
      this.width / 2 + this.shift[0] + s * dot(d, this.right),
      this.height / 2 + this.shift[1] - s * dot(d, this.above),
      dot(d, this.toward),
    ];
  }

  /** A world direction on the screen, for one metre: right, down [pixels], and toward the viewer [m]. */
  direct(v) {
    return [this.scale * dot(v, this.right), -this.scale * dot(v, this.above), dot(v, this.toward)];
  }
}
