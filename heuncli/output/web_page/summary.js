/** @file The summary table: the greatest loads of the run, when they occur, and their values at the shown frame. */

import { listArrowChoices, readVector } from "./arrows.js";
import { formatAllDigits, formatInstant, formatNumber, formatUnit } from "./digits.js";
import { makeElement } from "./elements.js";
import { norm } from "./poses.js";

const MAX_ROWS = 12; // rows
const MOMENTS = new Set(["T", "M", "M1", "M2"]);
const FORCES = new Set(["N", "Q", "Q1", "Q2"]);
const MIN_SHARE = 1e-3; // of the greatest of its kind: what is smaller is left to the tables

/** Find the frame at which a number is greatest, and its value there; NaN if it is open at all frames. */
function findGreatest(count, at) {
  let [best, most] = [-1, 0];
  for (let k = 0; k < count; k += 1) {
    const size = Math.abs(at(k));
    if (size > most || (best < 0 && size === 0)) [best, most] = [k, size];
  }
  return { frame: Math.max(best, 0), value: best < 0 ? NaN : at(best), size: most };
}

/** Make the entry of a vector: its magnitude over the frames. */
function makeVectorEntry({ row, name, vector }, count) {
  const at = (frame) => (vector ? row.parts[0].values[frame] : norm(readVector(row, frame)));
  const isReaction = row.path.startsWith("joints.") || row.path.startsWith("foundation.");
  const plain = row.path.endsWith("moment") && !vector ? `${name}, moment` : name;
  const caption = isReaction && !vector ? row.caption : plain;
  return { caption, path: row.path, row, at, ...findGreatest(count, at) };
}

/** Make the entries of a section: its greatest moment and force over all cuts; open where all cuts are. */
export function makeSectionEntries(section, count) {
  const n = section.cuts.length;
  const found = section.loads.map((load) => {
    const at = (frame) => {
      let most = NaN;
      for (const value of load.values.subarray(frame * n, (frame + 1) * n)) {
        if (Number.isNaN(most) || Math.abs(value) > Math.abs(most)) most = value;
      }
      return most;
    };
    return { caption: load.caption, path: load.path, row: load, at, ...findGreatest(count, at) };
  });
  found.sort((a, b) => b.size - a.size);
  const bending = found.filter(({ row }) => MOMENTS.has(row.label));
  const forces = found.filter(({ row }) => FORCES.has(row.label));
  return [...bending.slice(0, 1), ...forces.slice(0, 1)];
}

/** Group loads whose names differ in digits alone; the greatest of them stands for the group. */
function groupAlike(list) {
  const groups = new Map();
  for (const load of list) {
    const key = load.caption.replace(/\d+/g, "#");
    if (groups.has(key)) groups.get(key).push(load);
    else groups.set(key, [load]);
  }
  return [...groups.values()].map((group) => {
    const most = group.reduce((a, b) => (b.size > a.size ? b : a));
    const others = new Set(group.map(({ caption }) => caption)).size;
    return others > 1 ? Object.assign({}, most, { caption: `${most.caption} (greatest of ${others})` }) : most;
  });
}

/** Find the largest size of some entries, but for unbounded ones. */
const findLargestSize = (list) => Math.max(0, ...list.map(({ size }) => size).filter(Number.isFinite));

/** Make the rows of the summary, the greatest of each kind first. */
function makeRows(data) {
  const { count } = data;
  const choices = new Map(listArrowChoices(data).map((choice) => [choice.key, choice.rows]));
  const collect = (key) => {
    const entries = (choices.get(key) ?? []).map((each) => makeVectorEntry(each, count));
    const rows = entries.filter(({ size }) => size > 0);
    const forces = rows.filter(({ path }) => !path.endsWith("moment")).sort((a, b) => b.size - a.size);
    const moments = rows.filter(({ path }) => path.endsWith("moment")).sort((a, b) => b.size - a.size);
    return [forces, moments].flatMap((list) => list.filter(({ size }) => size > MIN_SHARE * findLargestSize(list)));
  };
  const ground = collect("foundation");
  const loads = groupAlike([...collect("joints.force"), ...collect("couplings"), ...collect("forces")]);
  const sections = data.sections.flatMap((section) => makeSectionEntries(section, count));
  const rest = MAX_ROWS - Math.min(4, sections.length) - ground.length;
  const shown = loads.slice(0, Math.max(4, rest));
  return [...shown, ...ground, ...sections].slice(0, MAX_ROWS);
}

/** The table. */
export class SummaryTable {
  /** @param {HTMLTableElement} table @param {object} data @param {object|null} crank the angle that names instants */
  constructor(table, data, crank, go) {
    this.cells = [];
    const isMoving = data.count > 1;
    const head = makeElement("tr");
    const titles = isMoving ? ["Load", "greatest", "unit", "at", "now"] : ["Load", "value", "unit"];
    head.append(...titles.map((name) => makeElement("th", name, { scope: "col", class: name })));
    const top = makeElement("thead");
    top.append(head);
    const body = makeElement("tbody");
    const span = data.time[data.count - 1] - data.time[0];
    for (const { caption, path, row, at, frame, value } of makeRows(data)) {
      const line = makeElement("tr");
      line.append(makeElement("th", caption, { scope: "row" }));
      const all = Number.isFinite(value) ? `${formatAllDigits(value * row.size)} ${row.unit}` : "";
      line.append(makeElement("td", formatNumber(value * row.size, row.style), { title: all }));
      line.append(makeElement("td", formatUnit(row.unit), { class: "unit" }));
      if (isMoving) {
        const turn = crank ? `${Math.round(crank.values[frame])}°` : "";
        const when = `${formatInstant(data.time[frame], span, 3)} s`;
        const button = makeElement("button", turn || when, { type: "button", title: when });
        button.setAttribute("aria-label", `Go to the greatest ${caption}, ${when}`);
        button.addEventListener("click", () => go(frame, path));
        const place = makeElement("td");
        if (!Number.isNaN(value)) place.append(button);
        const now = makeElement("td");
        this.cells.push({ now, at, row });
        line.append(place, now);
      }
      body.append(line);
    }
    table.replaceChildren(top, body);
  }

  /** Show the numbers of a frame. @param {number} frame */
  show(frame) {
    for (const cell of this.cells) {
      const text = formatNumber(cell.at(frame) * cell.row.size, cell.row.style);
      if (cell.text !== text) cell.now.textContent = cell.text = text;
    }
  }
}
