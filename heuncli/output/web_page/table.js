/** @file The numbers of the frame that is shown: a cell for each, with its path and all its digits in SI. */

import { formatShort, formatAllDigits, formatNumber } from "./digits.js";
import { makeElement } from "./elements.js";
import { along } from "./loads.js";
import { lengthOf } from "./vectors.js";

const COLUMNS = ["", "x", "y", "z", "value", ""];

/** A cell that is written at each frame. */
class Cell {
  /** @param {string} path @param {(frame: number) => number} value SI @param {string} missing what stands for nan */
  constructor(path, value, size, style, missing = "open") {
    this.element = makeElement("td", "", { "data-path": path });
    this.element.addEventListener("pointerenter", () => this.showDigits());
    Object.assign(this, { value, size, style, missing });
  }

  /** @param {number} frame */
  show(frame) {
    const value = this.value(frame);
    const text = Number.isNaN(value) ? this.missing : formatNumber(value * this.size, this.style);
    if (this.text !== text) this.element.textContent = this.text = text;
    this.element.dataset.value = Number.isFinite(value) ? String(value) : "";
  }

  /** All digits that the page holds, where somebody points at the number. */
  showDigits() {
    const value = Number(this.element.dataset.value) * this.size;
    this.element.title = this.element.dataset.value ? formatAllDigits(value) : "";
  }
}

/** Rows of one head. */
function addHeading(body, text, kind, note = "") {
  const row = makeElement("tr", "", { class: kind });
  const head = makeElement("th", text, { colspan: "6", scope: "rowgroup" });
  if (note) head.append(" ", makeElement("span", note));
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
    const head = makeElement("thead");
    const titles = makeElement("tr");
    for (const [k, name] of COLUMNS.entries()) {
      const title = makeElement("th", name, { scope: "col" });
      if (!name) title.append(makeElement("span", k ? "unit" : "what", { class: "hidden" }));
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
    const body = makeElement("tbody", "", { "data-kind": block.kind });
    addHeading(body, block.heading, "heading", block.note);
    for (const group of block.groups) {
      if (group.name || group.note) addHeading(body, group.name, "group", group.note);
      for (const row of group.rows) body.append(this.rowOf(row, block.missing));
    }
    for (const text of block.notes) {
      const line = makeElement("tr", "", { class: "notes" });
      line.append(makeElement("td", text, { colspan: "6" }));
      body.append(line);
    }
    this.table.append(body);
  }

  /** A quantity: its components and its size, or its one number. */
  rowOf(row, missing) {
    const line = makeElement("tr", "", { class: "row" });
    line.append(makeElement("th", row.label, { scope: "row" }));
    const pick = (part) => (frame) => part.values[row.fixed ? 0 : frame];
    const add = (path, value) => {
      const cell = new Cell(path, value, row.size, row.style, missing);
      this.cells.push(cell);
      line.append(cell.element);
    };
    if (row.parts.length === 1) {
      line.append(makeElement("td"), makeElement("td"), makeElement("td"));
      add(row.path, pick(row.parts[0]));
    } else {
      for (const part of row.parts) add(`${row.path}.${part.name}`, pick(part));
      if (row.sized) add(row.path, (frame) => lengthOf(row.parts.map((part) => pick(part)(frame))));
      else line.append(makeElement("td"));
    }
    line.append(makeElement("td", row.unit === "1" ? "" : row.unit, { class: "unit" }));
    return line;
  }

  /** The loads of a section; of a series of cuts those of the chosen cut, with the smallest and largest along it. */
  addSection(section, number) {
    const body = makeElement("tbody", "", { "data-kind": "sections" });
    if (number === 0) addHeading(body, this.data.cutting.heading, "heading", this.data.cutting.note);
    addHeading(body, section.name, "group", section.note);
    section.spoken = body.lastChild.firstChild.lastChild;
    section.chosen = 0;
    for (const load of section.loads) body.append(this.loadRow(section, load));
    this.table.append(body);
  }

  loadRow(section, load) {
    const line = makeElement("tr", "", { class: "row" });
    line.append(makeElement("th", load.label, { scope: "row" }));
    const range = makeElement("td", "", { colspan: "3" });
    const cell = new Cell(load.path, (frame) => along(section, load, frame)[section.chosen], load.size, load.style);
    this.cells.push(cell);
    if (section.s) {
      const unit = this.data.length;
      this.cells.push({ show: (frame) => this.showRange(range, section, load, frame, cell, unit) });
    }
    line.append(range, cell.element, makeElement("td", load.unit === "1" ? "" : load.unit, { class: "unit" }));
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
    const format = (k) => {
      const value = formatNumber(values[k] * load.size, load.style);
      return `${value} at ${formatShort(section.s[k] * size)} ${unit}`;
    };
    const text = low < 0 ? "" : `${format(low)} … ${format(high)}`;
    if (range.textContent !== text) range.textContent = text;
  }

  /** Write the numbers of a frame. @param {number} frame */
  show(frame) {
    for (const section of this.data.sections) {
      if (section.s) {
        const [unit, size] = this.data.length;
        const side = section.side[section.chosen] ? `, ${section.side[section.chosen]} the load there` : "";
        const place = `s = ${formatShort(section.s[section.chosen] * size)} ${unit}`;
        section.spoken.textContent = `${section.note}; value: at ${place}${side}`;
      }
    }
    for (const cell of this.cells) cell.show(frame);
    this.table.dataset.frame = String(frame);
  }
}
