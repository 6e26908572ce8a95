/** @file The view: where the viewer looks from, and the points of the machine to which it is fitted. */

import { computePoses, cross, dot, locatePoint, norm, normalize, subtract } from "./poses.js";

const MAX_FRAMES = 48;
const MAX_POINTS = 60000; // of all frames
const MAX_DISTANCE = 2; // times the machine's radius: what stands farther off its middle is not fitted
const GOLDEN = Math.PI * (3 - Math.sqrt(5));
const MAX_ELEVATION = Math.PI / 2;
const MAX_ZOOM = 400;
const ROOM = 0.14; // of the canvas: for words and arrows beside the machine
const CORNER = 26; // pixels: kept free below, for axes and scales
const MIN_EXTENT = 0.02; // of the scene's radius: what is thinner is not seen larger
const MAX_COVER = 0.01; // of the scene's radius cubed: where bodies hide the joints more, the view is from behind
const MAX_DEPTH = 0.6; // of the extent in its plane: a deeper machine is seen from aside (as in heun plot scene)
const MIN_ZOOM = 0.1;
const MIN_OFFSET = 0.02; // of the scene's radius: joints that stand no farther off its middle are in it

/** Make directions that are spread evenly over the sphere. @param {number} count */
function spreadDirections(count) {
  return Array.from({ length: count }, (_, k) => {
    const z = 1 - (2 * k + 1) / count;
    const r = Math.sqrt(1 - z * z);
    return [r * Math.cos(GOLDEN * k), r * Math.sin(GOLDEN * k), z];
  });
}

/** Split a list of numbers into points of three. */
export function splitPoints(list) {
  const found = [];
  for (let i = 0; i + 2 < list.length; i += 3) found.push([list[i], list[i + 1], list[i + 2]]);
  return found;
}

/** Find the points of a body that are farthest out in the given directions, body axes. */
function findOutermostPoints(body, directions) {
  const points = body.surfaces.flatMap((surface) => (surface.ball ? [] : splitPoints(surface.corners)));
  points.push(...[...body.bars, ...body.lines].flatMap(splitPoints));
  for (const { ball } of body.surfaces) {
    if (ball) points.push(...directions.map((d) => d.map((c, i) => ball.center[i] + ball.radius * c)));
  }
  if (points.length <= directions.length) return points;
  const best = directions.map((d) => points.reduce((far, p) => (dot(p, d) > dot(far, d) ? p : far)));
  return [...new Set(best)];
}

/**
 * How much of the machine's bodies stands before its joints, seen from a direction; large bodies count more.
 * @returns {(toward: number[]) => number} positive where large bodies hide the joints
 */
function makeCoverMeasure(scene) {
  const poses = computePoses(scene, 0, 0);
  const joints = scene.joints.map((joint) => locatePoint(poses, joint.b, joint.q));
  const directions = spreadDirections(20);
  const outlines = scene.bodies.map((body, k) =>
    findOutermostPoints(body, directions).map((p) => locatePoint(poses, k, p)),
  );
  const mean = (list, v) => list.reduce((sum, p) => sum + dot(p, v) / list.length, 0);
  const size = (list) => {
    const spans = [0, 1, 2].map((i) => Math.max(...list.map((p) => p[i])) - Math.min(...list.map((p) => p[i])));
    const [, medium, large] = spans.sort((a, b) => a - b);
    return medium * large;
  };
  return (toward) => {
    const middle = mean(joints, toward);
    return outlines.reduce((sum, list) => (list.length ? sum + size(list) * (mean(list, toward) - middle) : sum), 0);
  };
}

/**
 * Collect the points that a view must show: of bodies, joints and ropes at some of the frames, world axes [m].
 * @returns {number[][]}
 */
function collectCloudPoints(scene, count) {
  const frames = Math.min(count, MAX_FRAMES);
  const share = Math.floor(MAX_POINTS / Math.max(1, frames * scene.bodies.length));
  const directions = spreadDirections(Math.max(8, Math.min(80, share)));
  const outerPoints = scene.bodies.map((body) => findOutermostPoints(body, directions));
  const cloud = [];
  const ends = [...scene.joints, ...scene.lines];
  for (let k = 0; k < frames; k += 1) {
    const frame = frames > 1 ? Math.round((k * (count - 1)) / (frames - 1)) : 0;
    const poses = computePoses(scene, frame, 0);
    outerPoints.forEach((points, body) => points.forEach((p) => cloud.push(locatePoint(poses, body, p))));
    for (const { a, p, b, q } of ends) cloud.push(locatePoint(poses, a, p), locatePoint(poses, b, q));
    for (const { ends: found, count: spans } of scene.ropes) {
      cloud.push(...splitPoints(found.subarray(6 * spans * frame, 6 * spans * (frame + 1))));
    }
  }
  return cloud.filter((p) => norm(subtract(p, scene.center)) <= MAX_DISTANCE * scene.radius);
}

/** Prepare the scene of a load case for the view, once. @param {CaseData} data */
export function prepareView({ scene, count }) {
  scene.cloud ??= collectCloudPoints(scene, count);
  scene.cover ??= makeCoverMeasure(scene);
}

/** Find the world axis nearest to a direction. @param {number[]} v @returns {number[]} */
function findNearestAxis(v) {
  const k = [0, 1, 2].reduce((best, i) => (Math.abs(v[i]) > Math.abs(v[best]) ? i : best), 2);
  return [0, 1, 2].map((i) => (i === k ? Math.sign(v[k]) || 1 : 0));
}

/** Find the side on which most supports stand: 1 that of the plane's normal, -1 the other, 0 neither. */
function findSide(scene, normal) {
  const supports = scene.joints.flatMap(({ a, p, b, q }) => [...(a < 0 ? [p] : []), ...(b < 0 ? [q] : [])]);
  const places = [...scene.ground.map((point) => point.at), ...supports];
  const off = places.reduce((sum, at) => sum + dot(at, normal), 0) / (places.length || 1) - dot(scene.center, normal);
  return places.length > 0 && Math.abs(off) > MIN_OFFSET * scene.radius ? Math.sign(off) : 0;
}

/** Where the viewer looks from, by azimuth and elevation [rad]; up stays up on the screen. */
export class View {
  /** @param {Scene} scene */
  constructor(scene) {
    this.center = scene.center;
    this.radius = scene.radius;
    this.up = findNearestAxis(scene.gravity.some((g) => g !== 0) ? scene.gravity.map((g) => -g) : [0, 0, 1]);
    const normal = scene.normal && findNearestAxis(scene.normal);
    if (!scene.gravity.some((g) => g !== 0) && normal && Math.abs(normal[2]) === 1) this.up = [0, 1, 0];
    const k = this.up.findIndex((u) => u !== 0);
    const axis = (i) => [0, 1, 2].map((j) => (j === (k + i) % 3 ? 1 : 0));
    [this.first, this.second] = this.up[k] > 0 ? [axis(1), axis(2)] : [axis(2), axis(1)];
    this.normal = normal;
    this.cloud = scene.cloud;
    this.cover = scene.cover;
    this.side = normal ? findSide(scene, normal) : 0;
    this.width = 100;
    this.height = 100;
    this.reset();
  }

  /** Look as at the start: along the normal of the plane of motion, or obliquely at a deep machine. */
  reset() {
    if (this.normal && !this.isDeep()) {
      this.lookAlong(this.normal.map(Math.abs));
      if (this.cover && this.cover(this.toward) > MAX_COVER * this.radius ** 3) this.turn(Math.PI, 0);
      this.fit();
    } else {
      this.lookObliquely();
    }
  }

  /** Look as another view does, at the same machine in another load case. @param {View} other */
  copyFrom({ azimuth, elevation, fitted, zoom, shift, width, height }) {
    Object.assign(this, { azimuth, elevation });
    this.updateAxes();
    this.fit();
    if (!fitted) Object.assign(this, { fitted, zoom, shift, width, height });
  }

  /** Look from aside and above. */
  lookObliquely() {
    if (this.normal && Math.abs(dot(this.normal, this.up)) < 0.5) {
      this.lookAlong(this.normal.map(Math.abs));
      if (this.side * dot(this.normal, this.toward) < 0) this.turn(Math.PI, 0);
      this.turn(-0.4, 0.28);
    } else {
      this.azimuth = -1.05;
      this.elevation = this.normal ? 1 : 0.36;
      this.updateAxes();
    }
    this.fit();
  }

  /** Whether the machine extends far along the normal of its plane, as an engine of several cylinders does. */
  isDeep() {
    const span = (v) => this.findRange(v)[1] - this.findRange(v)[0];
    const across = [0, 1, 2].filter((i) => !this.normal[i]).map((i) => span([0, 1, 2].map((j) => Number(i === j))));
    return span(this.normal) > MAX_DEPTH * Math.max(...across);
  }

  /** Find the extent of the machine along a direction, from its middle [m]. @param {number[]} v */
  findRange(v) {
    let [low, high] = [Infinity, -Infinity];
    for (const p of this.cloud) {
      const at = dot(p, v);
      if (at < low) low = at;
      if (at > high) high = at;
    }
    const middle = dot(this.center, v);
    return [low - middle, high - middle];
  }

  /** Adapt to the size of the canvas [pixels]; the machine stays fitted until the user zooms or pans. */
  resize(width, height) {
    if (width === this.width && height === this.height) return;
    Object.assign(this, { width, height });
    if (this.fitted) this.fit();
  }

  /** Fit the machine at all frames into the canvas, with room for labels about it. */
  fit() {
    this.version = (this.version ?? 0) + 1;
    this.fitted = true;
    const [left, right] = this.findRange(this.right);
    const [low, high] = this.findRange(this.above);
    const minExtent = MIN_EXTENT * this.radius;
    const across = (this.width * (1 - ROOM)) / Math.max(right - left, minExtent);
    const up = (this.height * (1 - ROOM) - CORNER) / Math.max(high - low, minExtent);
    this.zoom = 1;
    this.zoom = Math.min(MAX_ZOOM, Math.max(MIN_ZOOM, Math.min(across, up) / this.scale));
    this.shift = [(-this.scale * (left + right)) / 2, (this.scale * (low + high)) / 2 - CORNER / 2];
  }

  /** Look along a world axis, so that the axes to the right and up are positive. @param {number[]} axis */
  lookAlong(axis) {
    const level = Math.abs(dot(axis, this.up)) < 0.5;
    const right = level ? cross(this.up, axis) : null;
    const toward = right && right.some((r) => r < 0) ? axis.map((c) => -c) : axis;
    this.elevation = level ? 0 : MAX_ELEVATION;
    this.azimuth = level ? Math.atan2(dot(toward, this.second), dot(toward, this.first)) : -Math.PI / 2;
    this.updateAxes();
  }

  /** Rotate the view. @param {number} aside [rad] @param {number} up [rad] */
  turn(aside, up) {
    this.azimuth += aside;
    this.elevation = Math.min(MAX_ELEVATION, Math.max(-MAX_ELEVATION, this.elevation + up));
    this.updateAxes();
  }

  /** Compute the axes of the screen from azimuth and elevation. */
  updateAxes() {
    const [c, s] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    this.toward = [0, 1, 2].map((i) => ce * (c * this.first[i] + s * this.second[i]) + se * this.up[i]);
    this.right = [0, 1, 2].map((i) => -s * this.first[i] + c * this.second[i]);
    this.above = normalize(cross(this.toward, this.right));
  }

  /** Zoom by a factor about a point of the screen [pixels]. */
  magnify(factor, x = this.width / 2, y = this.height / 2) {
    const zoom = Math.min(MAX_ZOOM, Math.max(MIN_ZOOM, this.zoom * factor));
    const real = zoom / this.zoom;
    this.fitted = false;
    this.zoom = zoom;
    const [cx, cy] = [x - this.width / 2, y - this.height / 2];
    this.shift = [cx + (this.shift[0] - cx) * real, cy + (this.shift[1] - cy) * real];
  }

  /** Pan [pixels]. */
  move(x, y) {
    this.fitted = false;
    this.shift = [this.shift[0] + x, this.shift[1] + y];
  }

  /** The scale [pixels/m]. */
  get scale() {
    return (0.43 * Math.min(this.width, this.height) * this.zoom) / this.radius;
  }

  /** Project a world point to the screen: right, down [pixels], and its nearness [m]. @param {number[]} p */
  project(p) {
    const d = [p[0] - this.center[0], p[1] - this.center[1], p[2] - this.center[2]];
    const s = this.scale;
    return [
      this.width / 2 + this.shift[0] + s * dot(d, this.right),
      this.height / 2 + this.shift[1] - s * dot(d, this.above),
      dot(d, this.toward),
    ];
  }

  /** Project a world vector to the screen: right, down [pixels], and toward the viewer [m]. */
  projectVector(v) {
    return [this.scale * dot(v, this.right), -this.scale * dot(v, this.above), dot(v, this.toward)];
  }
}
