/** @file The controls of the page: what they offer, and what they do when they are used. */

import { axesOf, coursesOf, madeOf } from "./courses.js";
import { instant } from "./digits.js";
import { findElement, fill, makeElement } from "./elements.js";
import { ZOOM, listenToPointers, viewKey } from "./pointing.js";
import { SPEEDS, speedFor } from "./player.js";
import { arrowChoices } from "./wrenches.js";

/** How opaque bodies are. */
const LOOKS = [
  [1, "solid"],
  [0.35, "transparent"],
  [0, "wireframe"],
];
const MANY_ARROWS = 40; // joints
const MANY_NAMES = 7;
const MOST_BUTTONS = 8;
const TRIED = 12;
const SIZES = 1.2; // by how much a step of the arrow size lengthens

/** What is chosen on the page beside the frame. */
export class Chosen {
  /** @param {object} data @param {() => void} changed @param {Chosen} [before] what was chosen in another load case */
  constructor(data, changed, before) {
    this.data = data;
    this.changed = changed;
    this.choices = arrowChoices(data);
    this.courses = coursesOf(data);
    this.axes = axesOf(data);
    this.axis = this.axes[1] ?? this.axes[0];
    /** @type {string[]} paths of the curves that are shown, the first of them chosen by itself */
    this.curves = [];
    this.names = data.scene.bodies.length + data.scene.joints.length <= MANY_NAMES;
    this.values = true;
    this.paths = false;
    this.look = 1;
    this.size = 1;
    const blow = data.count === 1 ? this.choices.find((choice) => choice.frame !== undefined) : null;
    const whole = data.scene.joints.length > MANY_ARROWS && this.choices.find((choice) => choice.key === "foundation");
    this.choice = blow || whole || this.choices[0] || null;
    this.section =
      data.sections.find((section) => section.loads.length && section.s) ??
      data.sections.find((section) => section.loads.length) ??
      null;
    this.load = null;
    this.band = true;
    if (before) this.take(before);
  }

  /** Choose what was chosen in another load case, as far as it is there. @param {Chosen} before */
  take({ names, values, paths, look, size, band, choice, section, load, curves, axis }) {
    Object.assign(this, { names, values, paths, look, size, band });
    const as = (list, other, key) => list.find((each) => each[key] === other?.[key]);
    this.choice = choice ? (as(this.choices, choice, "key") ?? this.choice) : null;
    this.section = as(this.data.sections, section, "name") ?? this.section;
    if (this.section && section?.chosen < this.section.cuts.length) this.section.chosen = section.chosen;
    this.load = (this.section && as(this.section.loads, load, "label")) ?? null;
    this.axis = as(this.axes, axis, "label") ?? this.axis;
    this.curves = curves.filter((path) => this.courses.some((course) => course.path === path));
    const unit = this.shownCourses[0]?.unit; // which may be another one in this case
    this.curves = this.curves.filter((_, k) => this.shownCourses[k].unit === unit);
  }

  /** The frame nearest to a place on an axis: the same angle or time as in another load case. */
  nearest(place) {
    const axis = this.axes.find(({ label }) => label === place?.label);
    if (!axis) return null;
    const off = (k) => Math.abs(axis.values[k] - place.at);
    return axis.values.reduce((best, _, k) => (off(k) < off(best) ? k : best), 0);
  }

  /** The load of the section that is looked at first: the bending that is largest, else the first there is. */
  governing() {
    const bending = this.section.loads.filter((load) => load.label === "M1" || load.label === "M2");
    const most = (load) => load.values.reduce((high, value) => Math.max(high, Math.abs(value) || 0), 0);
    return bending.sort((a, b) => most(b) - most(a))[0] ?? this.section.loads[0];
  }

  /** What is drawn of the machine beside its bodies, and how. */
  get shown() {
    const { names, values, paths, look, size, choice, section } = this;
    const load = section && this.load ? { section, force: this.load, cut: section.chosen ?? 0 } : null;
    return { names, values, paths, look, size, choice, load };
  }

  /** The path of the curve that is shown first: of the joint with the greatest force, else of whatever varies. */
  findLargestCourse() {
    const joints = this.courses.filter(({ path }) => /^joints\..*\.force$/.test(path)).slice(0, TRIED);
    const some = joints.length ? joints : this.courses.slice(0, TRIED);
    const most = ({ high }) => high.reduce((best, v) => (Math.abs(v) > best ? Math.abs(v) : best), 0);
    const found = some.map(madeOf).sort((a, b) => most(b) - most(a));
    return found[0]?.path ?? "";
  }

  /** Show the curve of a path alone. @param {string} path */
  setCourse(path) {
    const found = this.courses.find((course) => course.path === path) ?? this.courses[0];
    this.curves = found ? [found.path] : [];
  }

  /** The curves that are shown. @returns {import("./courses.js").Course[]} */
  get shownCourses() {
    return this.curves.map((path) => madeOf(this.courses.find((course) => course.path === path)));
  }

  /** The curves that may be added: of the unit of the first. */
  get others() {
    const unit = this.shownCourses[0]?.unit;
    return this.courses.filter((course) => course.unit === unit && !this.curves.includes(course.path));
  }
}

/** Whether a key belongs to the control that has the focus. @param {KeyboardEvent} event */
function isOwn(event) {
  const tag = event.target.tagName;
  if (tag === "SELECT" || tag === "TEXTAREA") return true;
  if (tag === "INPUT") return event.target.type === "range" ? event.key !== " " : event.key === " ";
  return (tag === "BUTTON" || tag === "SUMMARY") && (event.key === " " || event.key === "Enter");
}

/** The view's buttons, the pointer, the keys, until the signal. @param {AbortSignal} signal */
export function listenToView(view, player, changed, signal) {
  const canvas = findElement("machine");
  listenToPointers(canvas, view, changed);
  const act = (id, what) =>
    findElement(id).addEventListener("click", () => {
      what();
      changed();
    });
  ["x", "y", "z"].forEach((name, k) =>
    act(`view-${name}`, () => {
      view.along([0, 1, 2].map((i) => (i === k ? 1 : 0)));
      view.fit();
    }),
  );
  act("view-oblique", () => view.oblique());
  act("closer", () => view.magnify(ZOOM));
  act("farther", () => view.magnify(1 / ZOOM));
  const frames = player.time.length;
  const jumps = {
    " ": () => player.toggle(),
    Home: () => player.halt(0),
    End: () => player.halt(frames - 1),
    ",": () => player.halt(player.frame - 1),
    ".": () => player.halt(player.frame + 1),
  };
  const follow = (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey || isOwn(event)) return;
    if (jumps[event.key] && frames > 1) jumps[event.key]();
    else if (event.target === canvas && viewKey(event, view)) changed();
    else return;
    event.preventDefault();
  };
  document.addEventListener("keydown", follow, { signal });
}

/** Play, slider, speed, marks; nothing of it where there is one instant. @param {Player} [before] of another case */
export function listenToTime(data, player, before) {
  const { count, time, marks } = data;
  const moving = count > 1;
  for (const id of ["moving", "over", "marks", "worst"]) {
    findElement(id).hidden = !moving || (id === "marks" && !marks.length);
  }
  if (!moving) return;
  const slider = findElement("time");
  slider.max = String(count - 1);
  slider.addEventListener("input", () => player.halt(Number(slider.value)));
  findElement("ticks").append(...marks.map((mark) => makeElement("option", "", { value: String(mark.frame) })));
  findElement("play").addEventListener("click", () => player.toggle());
  findElement("worst").addEventListener("click", () => player.halt(data.worst));
  fill(
    findElement("speed"),
    SPEEDS.map(([speed, label]) => [String(speed), label]),
  );
  player.speed = before?.speed ?? speedFor(time[count - 1] - time[0]);
  findElement("repeat").checked = player.repeats = before?.repeats ?? true;
  findElement("speed").value = String(player.speed);
  findElement("speed").addEventListener("change", () => (player.speed = Number(findElement("speed").value)));
  findElement("repeat").addEventListener("change", () => (player.repeats = findElement("repeat").checked));
  const span = time[count - 1] - time[0];
  const buttons = marks.slice(0, MOST_BUTTONS).map((mark) => {
    const button = makeElement("button", `${mark.words} ${instant(mark.time, span)} s`, { type: "button" });
    button.addEventListener("click", () => player.halt(mark.frame));
    return button;
  });
  findElement("marks").replaceChildren(makeElement("span", "Events and impulses", { class: "word" }), ...buttons);
  const hidden = marks.length - MOST_BUTTONS;
  if (hidden > 0) findElement("marks").append(makeElement("span", `and ${hidden} more`));
}

/** What is drawn on the machine. */
export function listenToDrawn(chosen, player, changed) {
  const box = (id, field) => {
    findElement(id).checked = chosen[field];
    findElement(id).addEventListener("change", () => {
      chosen[field] = findElement(id).checked;
      changed();
    });
  };
  box("names", "names");
  box("values", "values");
  box("paths", "paths");
  findElement("pathslabel").hidden = chosen.data.count < 2;
  fill(
    findElement("bodies"),
    LOOKS.map(([opaque, label]) => [String(opaque), label]),
  );
  findElement("bodies").value = String(chosen.look);
  findElement("bodies").addEventListener("change", () => {
    chosen.look = Number(findElement("bodies").value);
    changed();
  });
  fill(findElement("reactions"), [...chosen.choices.map((choice) => [choice.key, choice.label]), ["", "none"]]);
  findElement("reactions").value = chosen.choice?.key ?? "";
  findElement("reactions").addEventListener("change", () => {
    chosen.choice = chosen.choices.find((choice) => choice.key === findElement("reactions").value) ?? null;
    if (chosen.choice?.frame !== undefined) player.halt(chosen.choice.frame);
    changed();
  });
  findElement("size").value = String(Math.round(Math.log(chosen.size) / Math.log(SIZES)));
  findElement("size").addEventListener("input", () => {
    chosen.size = SIZES ** Number(findElement("size").value);
    changed();
  });
}

/** Which load of which section, and at which cut. */
export function listenToSections(chosen, changed) {
  const { sections } = chosen.data;
  findElement("cutting").hidden = !sections.length;
  fill(
    findElement("section"),
    sections.map((section, k) => [String(k), section.name]),
  );
  const offer = () => {
    const { section } = chosen;
    const loads = section ? section.loads.map((load) => [load.label, load.label]) : [];
    fill(findElement("load"), [...loads, ["", "none"]]);
    findElement("load").value = chosen.load?.label ?? "";
    findElement("load").disabled = !section;
    findElement("cutlabel").hidden = !section?.s;
    findElement("cut").max = String((section?.cuts.length ?? 1) - 1);
    findElement("cut").value = String(section?.chosen ?? 0);
  };
  findElement("section").addEventListener("change", () => {
    const wanted = chosen.load?.label;
    chosen.section = sections[Number(findElement("section").value)];
    chosen.load = wanted
      ? (chosen.section.loads.find((load) => load.label === wanted) ?? chosen.governing() ?? null)
      : null;
    offer();
    changed();
  });
  findElement("load").addEventListener("change", () => {
    chosen.load = chosen.section?.loads.find((load) => load.label === findElement("load").value) ?? null;
    changed();
  });
  findElement("cut").addEventListener("input", () => {
    chosen.section.chosen = Number(findElement("cut").value);
    changed();
  });
  if (chosen.section) findElement("section").value = String(sections.indexOf(chosen.section));
  offer();
}
