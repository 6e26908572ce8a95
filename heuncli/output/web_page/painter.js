/** @file Painter's algorithm: collects faces, balls and lines, and paints the farthest first. */

const OVERLAP = 0.4; // pixels: how far beyond its sides a face is painted, so that no seam shows between two
const MIN_CORNER = 0.3; // where two sides meet in a point, that does not stand out farther

/** Trace a polygon: right, down, right, down, ... [pixels]. */
function tracePolygon(pen, points) {
  pen.beginPath();
  pen.moveTo(points[0], points[1]);
  for (let k = 2; k < points.length; k += 2) pen.lineTo(points[k], points[k + 1]);
}

/** Find the outward unit normal of a side of a polygon that faces the viewer. */
function findOutwardNormal(points, k, next) {
  const [dx, dy] = [points[next] - points[k], points[next + 1] - points[k + 1]];
  const size = Math.sqrt(dx * dx + dy * dy) || 1;
  return [-dy / size, dx / size];
}

/** Move the sides of a polygon outwards, so that neighbours overlap. @param {number[]} points */
function widenPolygon(points) {
  const n = points.length;
  const found = new Array(n);
  let [ax, ay] = findOutwardNormal(points, n - 2, 0);
  for (let k = 0; k < n; k += 2) {
    const [bx, by] = findOutwardNormal(points, k, (k + 2) % n);
    const share = OVERLAP / Math.max(MIN_CORNER, 1 + ax * bx + ay * by);
    found[k] = points[k] + share * (ax + bx);
    found[k + 1] = points[k + 1] + share * (ay + by);
    [ax, ay] = [bx, by];
  }
  return found;
}

/** Fill the traced path. */
function fillPath(pen, fill, opaque) {
  if (opaque === 0) return;
  pen.fillStyle = fill;
  pen.globalAlpha = opaque;
  pen.fill();
  pen.globalAlpha = 1;
}

/** Collects the items of a picture, then paints them. */
export class Painter {
  /** @param {CanvasRenderingContext2D} pen */
  constructor(pen) {
    this.pen = pen;
    /** @type {Item[]} */
    this.items = [];
  }

  /**
   * Add a face with some of its sides drawn.
   * @param {number} near @param {number[]} points @param {string} fill
   * @param {number[]} sides pieces of line: from right, down, to right, down, ... @param {string} line
   * @param {number} opacity how opaque the face is itself, 0 to 1
   */
  addFace(near, points, fill, sides, line, opacity) {
    this.items.push({
      near,
      paint: (pen, opaque) => {
        tracePolygon(pen, opacity * opaque === 1 ? widenPolygon(points) : points);
        fillPath(pen, fill, opacity * opaque);
        if (!sides.length) return;
        pen.beginPath();
        for (let k = 0; k < sides.length; k += 4) {
          pen.moveTo(sides[k], sides[k + 1]);
          pen.lineTo(sides[k + 2], sides[k + 3]);
        }
        pen.strokeStyle = line;
        pen.lineWidth = 1;
        pen.stroke();
      },
    });
  }

  /** Add a ball, lit from above left. @param {string[]} shades from dark to bright */
  addBall(near, x, y, radius, shades, line) {
    this.items.push({
      near,
      paint: (pen, opaque) => {
        pen.beginPath();
        pen.arc(x, y, radius, 0, 2 * Math.PI);
        const light = pen.createRadialGradient(x - 0.37 * radius, y - 0.5 * radius, 0, x, y, 1.15 * radius);
        shades.forEach((shade, k) => light.addColorStop(1 - k / (shades.length - 1), shade));
        fillPath(pen, light, opaque);
        pen.strokeStyle = line;
        pen.lineWidth = 1;
        pen.stroke();
      },
    });
  }

  /** Add a polyline. */
  addLine(near, points, line, width) {
    this.items.push({
      near,
      paint: (pen) => {
        tracePolygon(pen, points);
        pen.strokeStyle = line;
        pen.lineWidth = width;
        pen.stroke();
      },
    });
  }

  /** Add an item that paints itself. @param {number} near [m] @param {() => void} paint */
  add(near, paint) {
    this.items.push({ near, paint });
  }

  /** Paint all items, the farthest first. @param {number} opaque how opaque bodies are, 0 to 1 */
  paint(opaque) {
    this.items.sort((a, b) => a.near - b.near);
    this.pen.lineJoin = "round";
    this.pen.lineCap = "round";
    for (const item of this.items) item.paint(this.pen, opaque);
    this.items = [];
  }
}
