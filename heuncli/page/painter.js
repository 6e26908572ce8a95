/** @file What is nearer hides what is farther: faces and lines gathered, sorted by how near they are, painted in turn. */

/** @typedef {{near: number, points: number[], fill: string|null, line: string|null, width: number}} Item */

/** A painter; points are flat: right, down, right, down, ... [pixels]; near [m]. */
export class Painter {
  /** @param {CanvasRenderingContext2D} pen */
  constructor(pen) {
    this.pen = pen;
    /** @type {Item[]} */
    this.items = [];
    this.opaque = 1;
  }

  /** A face; the line in its colour closes the seams between neighbours. */
  face(near, points, fill) {
    this.items.push({ near, points, fill, line: fill, width: 0.7 });
  }

  /** A line. */
  line(near, points, line, width) {
    this.items.push({ near, points, fill: null, line, width });
  }

  /** Paint all that was gathered, the farthest first. */
  paint() {
    const { pen, items, opaque } = this;
    items.sort((a, b) => a.near - b.near);
    pen.lineJoin = "round";
    pen.lineCap = "round";
    for (const { points, fill, line, width } of items) {
      pen.beginPath();
      pen.moveTo(points[0], points[1]);
      for (let k = 2; k < points.length; k += 2) pen.lineTo(points[k], points[k + 1]);
      if (fill) {
        pen.closePath();
        pen.fillStyle = fill;
        pen.globalAlpha = opaque;
        pen.fill();
        pen.globalAlpha = 1;
        if (opaque < 1) continue;
      }
      pen.strokeStyle = line;
      pen.lineWidth = width;
      pen.stroke();
    }
    this.items = [];
  }
}
