/** @file Rotates, zooms and pans the machine by mouse, fingers and keys. */

const TURN = 0.008; // rad a pixel
const KEY_TURN = 0.1; // rad a key
const KEY_SHIFT = 24; // pixels a key
export const ZOOM = 1.15; // of one step
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/**
 * Let pointers on a canvas move the view.
 * @param {HTMLCanvasElement} canvas @param {import("./view.js").View} view @param {() => void} redraw
 */
export function listenToPointers(canvas, view, redraw) {
  /** @type {Map<number, number[]>} fingers or the mouse, by their numbers */
  const held = new Map();
  const spread = () => {
    const [a, b] = [...held.values()];
    return { apart: Math.hypot(a[0] - b[0], a[1] - b[1]) || 1, x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2 };
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    held.set(event.pointerId, [event.offsetX, event.offsetY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = held.get(event.pointerId);
    if (!last) return;
    const before = held.size === 2 ? spread() : null;
    held.set(event.pointerId, [event.offsetX, event.offsetY]);
    const [dx, dy] = [event.offsetX - last[0], event.offsetY - last[1]];
    if (before) {
      const after = spread();
      view.magnify(after.apart / before.apart, after.x, after.y);
      view.move(after.x - before.x, after.y - before.y);
    } else if (event.shiftKey || event.buttons > 1) {
      view.move(dx, dy);
    } else {
      view.turn(-TURN * dx, TURN * dy);
    }
    redraw();
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, (event) => held.delete(event.pointerId));
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      view.magnify(Math.exp(-0.0015 * event.deltaY * (event.deltaMode ? 30 : 1)), event.offsetX, event.offsetY);
      redraw();
    },
    { passive: false },
  );
}

/** Move the view by a key; returns whether the key has a meaning. @param {KeyboardEvent} event */
export function moveViewByKey(event, view) {
  const way = ARROWS[event.key];
  if (way && event.shiftKey) view.move(KEY_SHIFT * way[0], KEY_SHIFT * way[1]);
  else if (way) view.turn(KEY_TURN * way[0], -KEY_TURN * way[1]);
  else if (event.key === "+" || event.key === "=") view.magnify(ZOOM);
  else if (event.key === "-") view.magnify(1 / ZOOM);
  else if (event.key === "0") view.reset();
  else return false;
  return true;
}
