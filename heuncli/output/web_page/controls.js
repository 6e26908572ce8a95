/** @file The controls of the machine's picture: view, time, what is drawn, sections. Each changes the view, the player
 * or the selection, and asks for a new picture. */

import { formatInstant } from "./digits.js";
import { fillSelect, findElement, makeElement } from "./elements.js";
import { proposeSpeed, SPEEDS } from "./player.js";

const TURN = 0.008; // rad a pixel
const KEY_TURN = 0.1; // rad a key
const KEY_SHIFT = 24; // pixels a key
const ZOOM = 1.15; // of one step
/** By the key of an arrow: steps to the right, and down. */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const MAX_MARK_BUTTONS = 8;
const SIZE_STEP = 1.2; // factor of the arrow length for one step of its slider

/**
 * Let pointers on a canvas move the view.
 * @param {HTMLCanvasElement} canvas @param {View} view @param {() => void} redraw
 */
function listenToPointers(canvas, view, redraw) {
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
function moveViewByKey(event, view) {
  const [right, down] = ARROWS[event.key] ?? [0, 0];
  if (event.key in ARROWS && event.shiftKey) view.move(KEY_SHIFT * right, KEY_SHIFT * down);
  else if (event.key in ARROWS) view.turn(KEY_TURN * right, -KEY_TURN * down);
  else if (event.key === "+" || event.key === "=") view.magnify(ZOOM);
  else if (event.key === "-") view.magnify(1 / ZOOM);
  else if (event.key === "0") view.reset();
  else return false;
  return true;
}

/** How opaque bodies are drawn, and the word for it. */
const OPACITIES = [
  [1, "solid"],
  [0.35, "transparent"],
  [0, "wireframe"],
];

/** Whether the focused control uses a key itself, so that the page must leave it alone. @param {KeyboardEvent} event */
function isUsedByControl(event) {
  const tag = event.target.tagName;
  if (tag === "SELECT" || tag === "TEXTAREA") return true;
  if (tag === "INPUT") return event.target.type === "range" ? event.key !== " " : event.key === " ";
  return (tag === "BUTTON" || tag === "SUMMARY") && (event.key === " " || event.key === "Enter");
}

/** Let the buttons, the pointer and the keys move the view. @param {AbortSignal} signal ends the listening to keys */
export function listenToView(view, player, redraw, signal) {
  const canvas = findElement("machine");
  listenToPointers(canvas, view, redraw);
  const listenToClick = (id, act) =>
    findElement(id).addEventListener("click", () => {
      act();
      redraw();
    });
  ["x", "y", "z"].forEach((name, k) =>
    listenToClick(`view-${name}`, () => {
      view.lookAlong([0, 1, 2].map((i) => (i === k ? 1 : 0)));
      view.fit();
    }),
  );
  listenToClick("view-oblique", () => view.lookObliquely());
  listenToClick("closer", () => view.magnify(ZOOM));
  listenToClick("farther", () => view.magnify(1 / ZOOM));
  document.addEventListener("keydown", makeKeyListener(canvas, view, player, redraw), { signal });
}

function makeKeyListener(canvas, view, player, redraw) {
  const frames = player.time.length;
  const timeKeys = {
    " ": () => player.toggle(),
    Home: () => player.halt(0),
    End: () => player.halt(frames - 1),
    ",": () => player.halt(player.frame - 1),
    ".": () => player.halt(player.frame + 1),
  };
  return (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey || isUsedByControl(event)) return;
    if (timeKeys[event.key] && frames > 1) timeKeys[event.key]();
    else if (event.target === canvas && moveViewByKey(event, view)) redraw();
    else return;
    event.preventDefault();
  };
}

/** Let the time line work; it is hidden where there is one instant. @param {Player} [previous] of the case before */
export function listenToTime(data, player, previous) {
  const { count, time, marks } = data;
  const isMoving = count > 1;
  for (const id of ["moving", "over", "marks", "worst"]) {
    findElement(id).hidden = !isMoving || (id === "marks" && !marks.length);
  }
  if (!isMoving) return;
  const duration = time[count - 1] - time[0];
  const slider = findElement("time");
  slider.max = String(count - 1);
  slider.addEventListener("input", () => player.halt(Number(slider.value)));
  findElement("ticks").append(...marks.map((mark) => makeElement("option", "", { value: String(mark.frame) })));
  findElement("play").addEventListener("click", () => player.toggle());
  findElement("worst").addEventListener("click", () => player.halt(data.worst));
  const speed = findElement("speed");
  fillSelect(
    speed,
    SPEEDS.map(([value, label]) => [String(value), label]),
  );
  player.speed = previous?.speed ?? proposeSpeed(duration);
  speed.value = String(player.speed);
  speed.addEventListener("change", () => (player.speed = Number(speed.value)));
  const repeat = findElement("repeat");
  repeat.checked = player.repeats = previous?.repeats ?? true;
  repeat.addEventListener("change", () => (player.repeats = repeat.checked));
  showMarks(marks, duration, player);
}

/** Show a button for each of the first events and impulses. */
function showMarks(marks, duration, player) {
  const buttons = marks.slice(0, MAX_MARK_BUTTONS).map((mark) => {
    const button = makeElement("button", `${mark.words} ${formatInstant(mark.time, duration)} s`, { type: "button" });
    button.addEventListener("click", () => player.halt(mark.frame));
    return button;
  });
  findElement("marks").replaceChildren(makeElement("span", "Events and impulses", { class: "word" }), ...buttons);
  const hiddenCount = marks.length - MAX_MARK_BUTTONS;
  if (hiddenCount > 0) findElement("marks").append(makeElement("span", `and ${hiddenCount} more`));
}

/** Tie a check box to a field of the selection. @param {string} id @param {string} field */
export function listenToCheckBox(id, selection, field, redraw) {
  findElement(id).checked = selection[field];
  findElement(id).addEventListener("change", () => {
    selection[field] = findElement(id).checked;
    redraw();
  });
}

/** Let the user choose what is drawn on the machine, and how. */
export function listenToDrawing(selection, player, redraw) {
  for (const field of ["names", "values", "paths"]) listenToCheckBox(field, selection, field, redraw);
  findElement("pathslabel").hidden = selection.data.count < 2;
  const bodies = findElement("bodies");
  fillSelect(
    bodies,
    OPACITIES.map(([opacity, label]) => [String(opacity), label]),
  );
  bodies.value = String(selection.opacity);
  bodies.addEventListener("change", () => {
    selection.opacity = Number(bodies.value);
    redraw();
  });
  const arrows = findElement("reactions");
  fillSelect(arrows, [...selection.choices.map((choice) => [choice.key, choice.label]), ["", "none"]]);
  arrows.value = selection.choice?.key ?? "";
  arrows.addEventListener("change", () => {
    selection.choice = selection.choices.find((choice) => choice.key === arrows.value) ?? null;
    if (selection.choice?.frame !== undefined) player.halt(selection.choice.frame);
    redraw();
  });
  const size = findElement("size");
  size.value = String(Math.round(Math.log(selection.size) / Math.log(SIZE_STEP)));
  size.addEventListener("input", () => {
    selection.size = SIZE_STEP ** Number(size.value);
    redraw();
  });
}

/** Let the user choose a section, one of its loads, and a cut. */
export function listenToSections(selection, redraw) {
  const { sections } = selection.data;
  const [sectionSelect, loadSelect, cutSlider] = ["section", "load", "cut"].map(findElement);
  findElement("cutting").hidden = !sections.length;
  fillSelect(
    sectionSelect,
    sections.map((section, k) => [String(k), section.name]),
  );
  const showSection = () => {
    const { section } = selection;
    const loads = section ? section.loads.map((load) => [load.label, load.label]) : [];
    fillSelect(loadSelect, [...loads, ["", "none"]]);
    loadSelect.value = selection.load?.label ?? "";
    loadSelect.disabled = !section;
    findElement("cutlabel").hidden = !section?.s;
    cutSlider.max = String((section?.cuts.length ?? 1) - 1);
    cutSlider.value = String(section ? selection.getCutNumber(section) : 0);
  };
  const findLoad = (label) => selection.section?.loads.find((load) => load.label === label) ?? null;
  sectionSelect.addEventListener("change", () => {
    const label = selection.load?.label;
    selection.section = sections[Number(sectionSelect.value)];
    selection.load = label ? (findLoad(label) ?? selection.findGoverningLoad() ?? null) : null;
    showSection();
    redraw();
  });
  loadSelect.addEventListener("change", () => {
    selection.load = findLoad(loadSelect.value);
    redraw();
  });
  cutSlider.addEventListener("input", () => {
    selection.cutNumbers.set(selection.section.name, Number(cutSlider.value));
    redraw();
  });
  if (selection.section) sectionSelect.value = String(sections.indexOf(selection.section));
  showSection();
}
