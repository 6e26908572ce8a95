/** @file What the user has selected on the page: arrows, section load, curves, looks; all but the frame. */

import { listArrowChoices } from "./arrows.js";
import { computeHistory, getAxes, getHistories } from "./histories.js";

const MAX_JOINT_ARROWS = 40; // with more joints the load on the ground is drawn first, so that arrows do not overlap
const MAX_NAMES = 7; // bodies and joints: with more of them names start switched off
const MAX_RANKED = 12; // histories that are computed to find the one with the largest value

/** The largest magnitude among numbers that may be NaN. @param {ArrayLike<number>} values */
function findMagnitude(values) {
  return values.reduce((largest, value) => Math.max(largest, Math.abs(value) || 0), 0);
}

/** The selection of one load case; it calls nobody when it changes: whoever changes it redraws. */
export class Selection {
  /**
   * @param {CaseData} data of the case
   * @param {Selection} [previous] of the case before, which is kept where it can be
   */
  constructor(data, previous) {
    this.data = data;
    this.choices = listArrowChoices(data);
    this.histories = getHistories(data);
    this.axes = getAxes(data);
    this.axis = this.axes[1] ?? this.axes[0];
    /** @type {string[]} paths of the curves; the first is the one that the select box shows */
    this.curves = [];
    this.names = data.scene.bodies.length + data.scene.joints.length <= MAX_NAMES;
    this.values = true;
    this.paths = false;
    this.opacity = 1;
    this.size = 1;
    const hasCrowd = data.scene.joints.length > MAX_JOINT_ARROWS;
    const impulse = data.count === 1 && this.choices.find((choice) => choice.frame !== undefined);
    const foundation = hasCrowd && this.choices.find((choice) => choice.key === "foundation");
    this.choice = impulse || foundation || this.choices[0] || null;
    const loaded = data.sections.filter((section) => section.loads.length);
    this.section = loaded.find((section) => section.s) ?? loaded[0] ?? null;
    this.load = null;
    /** @type {Map<string, number>} the chosen cut of each section by its name, where it is not the first */
    this.cutNumbers = new Map();
    this.hasEnvelope = true;
    if (previous) this.copyFrom(previous);
  }

  /** Select what another case has selected, as far as this case has it. @param {Selection} previous */
  copyFrom(previous) {
    const { names, values, paths, opacity, size, hasEnvelope, choice, section, load, curves, axis } = previous;
    Object.assign(this, { names, values, paths, opacity, size, hasEnvelope });
    const findSame = (list, other, key) => list.find((each) => each[key] === other?.[key]);
    this.choice = choice ? (findSame(this.choices, choice, "key") ?? this.choice) : null;
    this.section = findSame(this.data.sections, section, "name") ?? this.section;
    for (const { name, cuts } of this.data.sections) {
      const cutNumber = previous.cutNumbers.get(name);
      if (cutNumber < cuts.length) this.cutNumbers.set(name, cutNumber);
    }
    this.load = (this.section && findSame(this.section.loads, load, "label")) ?? null;
    this.axis = findSame(this.axes, axis, "label") ?? this.axis;
    this.curves = curves.filter((path) => this.histories.some((history) => history.path === path));
    const unit = this.shownHistories[0]?.unit; // a quantity may have another unit in this case
    this.curves = this.curves.filter((_, k) => this.shownHistories[k].unit === unit);
  }

  /** Get the number of the chosen cut of a section. @param {object} section */
  getCutNumber(section) {
    return this.cutNumbers.get(section.name) ?? 0;
  }

  /** The frame at the same angle or time as in another case. @param {{label: string, value: number}} [place] */
  findNearestFrame(place) {
    const axis = this.axes.find(({ label }) => label === place?.label);
    if (!axis) return null;
    const distance = (k) => Math.abs(axis.values[k] - place.value);
    return axis.values.reduce((best, _, k) => (distance(k) < distance(best) ? k : best), 0);
  }

  /** The section load to look at first: the larger bending moment, else the first load of all. */
  findGoverningLoad() {
    const bending = this.section.loads.filter((load) => load.label === "M1" || load.label === "M2");
    return bending.sort((a, b) => findMagnitude(b.values) - findMagnitude(a.values))[0] ?? this.section.loads[0];
  }

  /** What `drawMachine` needs beside the frame. */
  get drawOptions() {
    const { names, values, paths, opacity, size, choice, section } = this;
    const load = section && this.load ? { section, force: this.load, cut: this.getCutNumber(section) } : null;
    return { names, values, paths, opacity, size, choice, load };
  }

  /** The path of the curve to show first: the largest joint force, else the largest number of any kind. */
  findLargestHistory() {
    const forces = this.histories.filter(({ path }) => /^joints\..*\.force$/.test(path));
    const candidates = (forces.length ? forces : this.histories).slice(0, MAX_RANKED).map(computeHistory);
    candidates.sort((a, b) => findMagnitude(b.high) - findMagnitude(a.high));
    return candidates[0]?.path ?? "";
  }

  /** Show one curve alone. @param {string} path */
  showHistory(path) {
    const history = this.histories.find((each) => each.path === path) ?? this.histories[0];
    this.curves = history ? [history.path] : [];
  }

  /** The curves that are shown. @returns {TimeHistory[]} */
  get shownHistories() {
    return this.curves.map((path) => computeHistory(this.histories.find((history) => history.path === path)));
  }

  /** The curves that may be added: those in the unit of the first, since they share its axis. */
  get addableHistories() {
    const unit = this.shownHistories[0]?.unit;
    return this.histories.filter((history) => history.unit === unit && !this.curves.includes(history.path));
  }
}
