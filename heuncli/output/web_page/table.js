/** @file The numbers of the frame that is shown: a cell for each, with its path and all its digits in SI. */

import { short, whole, written } from "./digits.js";
import { made } from "./elements.js";
import { along } from "./loads.js";
import { lengthOf } from "./vectors.js";

const COLUMNS = ["", "x", "y", "z", "value", ""];

/** A cell that is written at each frame. */
class Cell {
  /** @param {string} path @param {(frame: number) => number} value SI @param {string} missing what stands for nan */
  constructor(path, value, size, style, missing = "open") {
    this.element = made("td", "", { "data-path": path });
    this.element.addEventListener("pointerenter", () => this.tell());
    Object.assign(this, { value, size, style, missing });
  }

  /** @param {number} frame */
  show(frame) {
    const value = this.value(frame);
    const text = Number.isNaN(value) ? this.missing : written(value * this.size, this.style);
    if (this.text !== text) this.element.textContent = this.text = text;
    this.element.dataset.value = Number.isFinite(value) ? String(value) : "";
  }

  /** All digits that the page holds, where somebody points at the number. */
  tell() {
    const value = Number(this.element.dataset.value) * this.size;
    this.element.title = this.element.dataset.value ? whole(value) : "";
  }
}

/** Rows of one head. */
function headed(body, text, kind, note = "") {
  const row = made("tr", "", { class: kind });
  const head = made("th", text, { colspan: "6", scope: "rowgroup" });
  if (note) head.append(" ", made("span", note));
  row.append(head);
  body.append(row);
}

/** The table. */
export class NumberTable {
  /** @param {HTMLTableElement} table @param {object} data */
  constructor(table, data) {
    this.table = table;
    this.data = data;
    /** @type {Cell[]} */
    this.cells = [];
    this.cut = 0;
    this.parts = new Map();
    const head = made("thead");
    const titles = made("tr");
    for (const [k, name] of COLUMNS.entries()) {
      const title = made("th", name, { scope: "col" });
      if (!name) title.append(made("span", k ? "unit" : "what", { class: "hidden" }));
      titles.append(title);
    }
    head.append(titles);
    table.append(head);
    data.sections.forEach((section, k) => this.addSection(section, k));
    for (const block of data.blocks) this.addBlock(block);
    for (const blow of data.blows) blow.blocks.forEach((block) => this.addBlock(block));
  }

  /** Show the tables of a kind alone. @param {string} kind joints, sections or all */
  choose(kind) {
    for (const body of this.table.tBodies) body.hidden = kind !== "all" && body.dataset.kind !== kind;
  }

  /** Whether there are tables of a kind. */
  has(kind) {
    return [...this.table.tBodies].some((body) => body.dataset.kind === kind);
  }

  /** A block of rows under its heading, which tells axes and signs. */
  addBlock(block) {
    const body = made("tbody", "", { "data-kind": block.kind });
    headed(body, block.heading, "heading", block.note);
    for (const group of block.groups) {
      if (group.name || group.note) headed(body, group.name, "group", group.note);
      for (const row of group.rows) body.append(this.rowOf(row, block.missing));
    }
    for (const text of block.notes) {
      const line = made("tr", "", { class: "notes" });
      line.append(made("td", text, { colspan: "6" }));
      body.append(line);
    }
    this.table.append(body);
  }

  /** A quantity: its components and its size, or its one number. */
  rowOf(row, missing) {
    const line = made("tr", "", { class: "row" });
    line.append(made("th", row.label, { scope: "row" }));
    const pick = (part) => (frame) => part.values[row.fixed ? 0 : frame];
    const add = (path, value) => {
      const cell = new Cell(path, value, row.size, row.style, missing);
      this.cells.push(cell);
      line.append(cell.element);
    };
    if (row.parts.length === 1) {
      line.append(made("td"), made("td"), made("td"));
      add(row.path, pick(row.parts[0]));
    } else {
      for (const part of row.parts) add(`${row.path}.${part.name}`, pick(part));
      if (row.sized) add(row.path, (frame) => lengthOf(row.parts.map((part) => pick(part)(frame))));
      else line.append(made("td"));
    }
    line.append(made("td", row.unit === "1" ? "" : row.unit, { class: "unit" }));
    return line;
  }

  /** The loads of a section; of a series of cuts those of the chosen cut, with the smallest and largest along it. */
  addSection(section, number) {
    const body = made("tbody", "", { "data-kind": "sections" });
    if (number === 0) headed(body, this.data.cutting.heading, "heading", this.data.cutting.note);
    headed(body, section.name, "group", section.note);
    section.spoken = body.lastChild.firstChild.lastChild;
    section.chosen = 0;
    for (const load of section.loads) body.append(this.loadRow(section, load));
    this.table.append(body);
  }

  loadRow(section, load) {
    const line = made("tr", "", { class: "row" });
    line.append(made("th", load.label, { scope: "row" }));
    const range = made("td", "", { colspan: "3" });
    const cell = new Cell(load.path, (frame) => along(section, load, frame)[section.chosen], load.size, load.style);
    this.cells.push(cell);
    if (section.s) {
      const unit = this.data.length;
      this.cells.push({ show: (frame) => this.showRange(range, section, load, frame, cell, unit) });
    }
    line.append(range, cell.element, made("td", load.unit === "1" ? "" : load.unit, { class: "unit" }));
    return line;
  }

  /** Least and greatest along a run, with their places; and of which cut the number beside is. */
  showRange(range, section, load, frame, cell, [unit, size]) {
    cell.element.dataset.path = `${load.path}.${section.chosen}`;
    const values = along(section, load, frame);
    let [low, high] = [-1, -1];
    for (let k = 0; k < values.length; k += 1) {
      if (Number.isNaN(values[k])) continue;
      if (low < 0 || values[k] < values[low]) low = k;
      if (high < 0 || values[k] > values[high]) high = k;
    }
    const tell = (k) => `${written(values[k] * load.size, load.style)} at ${short(section.s[k] * size)} ${unit}`;
    const text = low < 0 ? "" : `${tell(low)} … ${tell(high)}`;
    if (range.textContent !== text) range.textContent = text;
  }

  /** Write the numbers of a frame. @param {number} frame */
  show(frame) {
    for (const section of this.data.sections) {
      if (section.s) {
        const [unit, size] = this.data.length;
        const side = section.side[section.chosen] ? `, ${section.side[section.chosen]} the load there` : "";
        const place = `s = ${short(section.s[section.chosen] * size)} ${unit}`;
        section.spoken.textContent = `${section.note}; value: at ${place}${side}`;
      }
    }
    for (const cell of this.cells) cell.show(frame);
    this.table.dataset.frame = String(frame);
  }
}
