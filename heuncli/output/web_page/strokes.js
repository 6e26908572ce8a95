/** @file Draws in pixels: lines, shapes, arrows and text on sharp canvases, in the colours of the style sheet. */

/** The font of all text on canvases. */
export const FONT = '12px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';
const HEAD = 9; // pixels: of an arrow
/** Custom properties of the style sheet. */
const COLOUR_NAMES = ["paper", "ink", "faint", "line", "panel", "accent", "positive", "negative", "force", "moment"];

/** Read the colours of the style sheet, light or dark. @returns {Colours} */
export function readColours() {
  const style = getComputedStyle(document.documentElement);
  const found = { dark: matchMedia("(prefers-color-scheme: dark)").matches };
  for (const name of COLOUR_NAMES) found[name] = style.getPropertyValue(`--${name}`).trim();
  return found;
}

/** Draw a polyline. @param {number[][]} points */
export function drawPolyline(pen, points, colour, width = 1.5, dash = []) {
  pen.beginPath();
  points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dash);
  pen.stroke();
  pen.setLineDash([]);
}

/** Draw a closed shape. @param {number[][]} points */
export function drawShape(pen, points, fill, line, width = 1.5) {
  pen.beginPath();
  points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.closePath();
  pen.fillStyle = fill;
  pen.fill();
  pen.strokeStyle = line;
  pen.lineWidth = width;
  pen.stroke();
}

/** Draw a circle. */
export function drawRing(pen, x, y, radius, fill, line, width = 1.6) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.fill();
  pen.strokeStyle = line;
  pen.lineWidth = width;
  pen.stroke();
}

/** Draw text with a rim of the background's colour, so that it is readable on anything; x: its left end. */
export function drawText(pen, text, x, y, colour, paper) {
  pen.font = FONT;
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  pen.lineJoin = "round";
  pen.lineWidth = 3.5;
  pen.strokeStyle = paper;
  pen.strokeText(text, x, y);
  pen.fillStyle = colour;
  pen.fillText(text, x, y);
}

/**
 * Draw an arrow; a moment has two heads.
 * @param {number[]} from @param {number[]} to on the screen [pixels]
 * @param {number} toward the viewer [pixels]
 */
export function drawArrow(pen, from, to, toward, colour, paper, heads = 1, dash = []) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  if (length < 4) {
    if (Math.abs(toward) >= 8) drawArrowEndOn(pen, from, toward, colour, paper);
    return;
  }
  const [ux, uy] = [dx / length, dy / length];
  const head = Math.min(HEAD, 0.6 * length);
  const neck = [to[0] - 0.8 * head * ux, to[1] - 0.8 * head * uy];
  drawPolyline(pen, [from, neck], paper, 5);
  drawPolyline(pen, [from, neck], colour, 2.4, dash);
  for (let k = 0; k < heads; k += 1) {
    const [x, y] = [to[0] - 0.75 * k * head * ux, to[1] - 0.75 * k * head * uy];
    const [bx, by] = [x - head * ux, y - head * uy];
    const w = 0.42 * head;
    drawShape(
      pen,
      [
        [x, y],
        [bx - w * uy, by + w * ux],
        [bx + w * uy, by - w * ux],
      ],
      colour,
      paper,
      0.8,
    );
  }
}

/** Draw an arrow seen from its tip (a dot) or from its tail (a cross). */
function drawArrowEndOn(pen, [x, y], toward, colour, paper) {
  drawRing(pen, x, y, 7, paper, colour, 2.2);
  if (toward > 0) {
    drawRing(pen, x, y, 2.2, colour, colour, 1);
  } else {
    drawPolyline(
      pen,
      [
        [x - 4.5, y - 4.5],
        [x + 4.5, y + 4.5],
      ],
      colour,
      2,
    );
    drawPolyline(
      pen,
      [
        [x - 4.5, y + 4.5],
        [x + 4.5, y - 4.5],
      ],
      colour,
      2,
    );
  }
}

/**
 * Clear a canvas and return its pen; the units are CSS pixels.
 * @param {HTMLCanvasElement} canvas
 * @returns {{pen: CanvasRenderingContext2D, width: number, height: number}}
 */
export function clearCanvas(canvas) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const fine = window.devicePixelRatio || 1;
  const [w, h] = [Math.round(width * fine), Math.round(height * fine)];
  if (canvas.width !== w) canvas.width = w;
  if (canvas.height !== h) canvas.height = h;
  const pen = canvas.getContext("2d");
  pen.setTransform(fine, 0, 0, fine, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}
