/** @file What is nearer hides what is farther: faces, balls and lines, gathered, then painted, the farthest first. */

const WIDER = 0.4; // pixels: how far beyond its sides a face is painted, so that no seam shows between two
const SHARPEST = 0.3; // where two sides meet in a point, that does not stand out farther

/**
 * @typedef {object} Item
 * @property {number} near how near to the viewer [m]
 * @property {(pen: CanvasRenderingContext2D, opaque: number) => void} paint what paints it
 */

/** Go round a polygon: right, down, right, down, ... [pixels]. */
function round(pen, points) {
  pen.beginPath();
  pen.moveTo(points[0], points[1]);
  for (let k = 2; k < points.length; k += 2) pen.lineTo(points[k], points[k + 1]);
}

/** The direction out of a polygon that looks at the viewer, across one of its sides; of unit length. */
function outOf(points, k, next) {
  const [dx, dy] = [points[next] - points[k], points[next + 1] - points[k + 1]];
  const size = Math.sqrt(dx * dx + dy * dy) || 1;
  return [-dy / size, dx / size];
}

/** A polygon whose sides are moved out. @param {number[]} points */
function widened(points) {
  const n = points.length;
  const found = new Array(n);
  let [ax, ay] = outOf(points, n - 2, 0);
  for (let k = 0; k < n; k += 2) {
    const [bx, by] = outOf(points, k, (k + 2) % n);
    const share = WIDER / Math.max(SHARPEST, 1 + ax * bx + ay * by);
    found[k] = points[k] + share * (ax + bx);
    found[k + 1] = points[k + 1] + share * (ay + by);
    [ax, ay] = [bx, by];
  }
  return found;
}

/** Fill what was gone round, as opaque as bodies are. */
function filled(pen, fill, opaque) {
  if (opaque === 0) return;
  pen.fillStyle = fill;
  pen.globalAlpha = opaque;
  pen.fill();
  pen.globalAlpha = 1;
}

/** A painter. */
export class Painter {
  /** @param {CanvasRenderingContext2D} pen */
  constructor(pen) {
    this.pen = pen;
    /** @type {Item[]} */
    this.items = [];
  }

  /**
   * A face with some of its sides drawn.
   * @param {number} near @param {number[]} points @param {string} fill
   * @param {number[]} sides pieces of line: from right, down, to right, down, ... @param {string} line
   * @param {number} own how opaque it is itself, 0 to 1
   */
  face(near, points, fill, sides, line, own) {
    this.items.push({
      near,
      paint: (pen, opaque) => {
        round(pen, own * opaque === 1 ? widened(points) : points);
        filled(pen, fill, own * opaque);
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

  /** A ball, lit from above left. @param {string[]} shades from dark to bright */
  ball(near, x, y, radius, shades, line) {
    this.items.push({
      near,
      paint: (pen, opaque) => {
        pen.beginPath();
        pen.arc(x, y, radius, 0, 2 * Math.PI);
        const light = pen.createRadialGradient(x - 0.37 * radius, y - 0.5 * radius, 0, x, y, 1.15 * radius);
        shades.forEach((shade, k) => light.addColorStop(1 - k / (shades.length - 1), shade));
        filled(pen, light, opaque);
        pen.strokeStyle = line;
        pen.lineWidth = 1;
        pen.stroke();
      },
    });
  }

  /** A line. */
  line(near, points, line, width) {
    this.items.push({
      near,
      paint: (pen) => {
        round(pen, points);
        pen.strokeStyle = line;
        pen.lineWidth = width;
        pen.stroke();
      },
    });
  }

  /** Anything else, by what paints it. @param {number} near [m] @param {() => void} paint */
  add(near, paint) {
    this.items.push({ near, paint });
  }

  /** Paint all that was gathered, the farthest first. @param {number} opaque how opaque bodies are, 0 to 1 */
  paint(opaque) {
    this.items.sort((a, b) => a.near - b.near);
    this.pen.lineJoin = "round";
    this.pen.lineCap = "round";
    for (const item of this.items) item.paint(this.pen, opaque);
    this.items = [];
  }
}
