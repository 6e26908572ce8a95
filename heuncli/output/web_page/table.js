/** @file The tables of all numbers at the shown frame, and the tabs that choose among them; each cell also holds its
 * path and its value in SI. */

import { formatAllDigits, formatNumber, formatShort, formatUnit } from "./digits.js";
import { findElement, makeElement } from "./elements.js";
import { getLoadsAlong } from "./loads.js";
import { norm } from "./poses.js";

const TABS = ["summary", "joints", "sections", "all"];
const COLUMNS = ["", "x", "y", "z", "value", ""];

/** A cell whose number follows the frame. */
class NumberCell {
  /**
   * @param {string} path of the number @param {(frame: number) => number} read its value, SI
   * @param {Shown} shown its unit and digits @param {string} missing what is written for NaN
   */
  constructor(path, read, shown, missing = "open") {
    this.element = makeElement("td", "", { "data-path": path });
    this.element.addEventListener("pointerenter", () => this.showDigits());
    Object.assign(this, { read, shown, missing });
  }

  /** @param {number} frame */
  show(frame) {
    const value = this.read(frame);
    const text = Number.isNaN(value) ? this.missing : formatNumber(value * this.shown.size, this.shown.style);
    if (this.text !== text) this.element.textContent = this.text = text;
    this.element.dataset.value = Number.isFinite(value) ? String(value) : "";
  }

  /** Show all digits that the page holds when the pointer is on the number. */
  showDigits() {
    const value = Number(this.element.dataset.value) * this.shown.size;
    this.element.title = this.element.dataset.value ? formatAllDigits(value) : "";
  }
}

/** A cell with the smallest and the largest value along a run of cuts, and their positions. */
class RangeCell {
  /** @param {PageSection} section @param {SectionLoad} load @param {[string, number]} length unit, and it per metre */
  constructor(section, load, length) {
    this.element = makeElement("td", "", { colspan: "3" });
    Object.assign(this, { section, load, length });
  }

  /** @param {number} frame */
  show(frame) {
    const values = getLoadsAlong(this.section, this.load, frame);
    let [low, high] = [-1, -1];
    for (let k = 0; k < values.length; k += 1) {
      if (Number.isNaN(values[k])) continue;
      if (low < 0 || values[k] < values[low]) low = k;
      if (high < 0 || values[k] > values[high]) high = k;
    }
    const text = low < 0 ? "" : `${this.formatCut(values, low)} … ${this.formatCut(values, high)}`;
    if (this.element.textContent !== text) this.element.textContent = text;
  }

  /** Format the value at a cut with its position. @param {Float64Array} values @param {number} k number of the cut */
  formatCut(values, k) {
    const [unit, perMetre] = this.length;
    const value = formatNumber(values[k] * this.load.size, this.load.style);
    return `${value} at ${formatShort(this.section.s[k] * perMetre)} ${unit}`;
  }
}

/** Add a row that is a heading. @returns {HTMLElement} the element of the note beside its name */
function addHeading(body, text, kind, note = "") {
  const row = makeElement("tr", "", { class: kind });
  const head = makeElement("th", text, { colspan: "6", scope: "rowgroup" });
  const noteElement = makeElement("span", note);
  if (note) head.append(" ", noteElement);
  row.append(head);
  body.append(row);
  return noteElement;
}

/** Make the head of the table; columns without a title have one for screen readers. */
function makeTableHead() {
  const titles = makeElement("tr");
  for (const [k, name] of COLUMNS.entries()) {
    const title = makeElement("th", name, { scope: "col" });
    if (!name) title.append(makeElement("span", k ? "unit" : "what", { class: "hidden" }));
    titles.append(title);
  }
  const head = makeElement("thead");
  head.append(titles);
  return head;
}

/** The table of all numbers. */
export class NumberTable {
  /**
   * @param {HTMLTableElement} table @param {CaseData} data
   * @param {Selection} selection
   */
  constructor(table, data, selection) {
    this.table = table;
    this.data = data;
    /** @type {(NumberCell|RangeCell)[]} all that follow the frame */
    this.cells = [];
    /** @type {{section: PageSection, load: SectionLoad, cell: NumberCell}[]} the values at chosen cuts */
    this.cutCells = [];
    this.selection = selection;
    /** @type {Map<object, HTMLElement>} the element beside each section's name */
    this.sectionNotes = new Map();
    table.append(makeTableHead());
    data.sections.forEach((section, k) => this.addSection(section, k));
    for (const block of data.blocks) this.addBlock(block);
    for (const impulse of data.impulses) impulse.blocks.forEach((block) => this.addBlock(block));
  }

  /** Show only the tables of a kind. @param {string} kind joints, sections or all */
  showKind(kind) {
    for (const body of this.table.tBodies) body.hidden = kind !== "all" && body.dataset.kind !== kind;
  }

  /** Whether there is a table of a kind. */
  hasKind(kind) {
    return [...this.table.tBodies].some((body) => body.dataset.kind === kind);
  }

  /** Add a block of rows under its heading, which states axes and signs. */
  addBlock(block) {
    const body = makeElement("tbody", "", { "data-kind": block.kind });
    addHeading(body, block.heading, "heading", block.note);
    for (const group of block.groups) {
      if (group.name || group.note) addHeading(body, group.name, "group", group.note);
      for (const row of group.rows) body.append(this.makeRow(row, block.missing));
    }
    for (const text of block.notes) {
      const line = makeElement("tr", "", { class: "notes" });
      line.append(makeElement("td", text, { colspan: "6" }));
      body.append(line);
    }
    this.table.append(body);
  }

  /** Make the row of a quantity: its components and magnitude, or its one number. */
  makeRow(row, missing) {
    const line = makeElement("tr", "", { class: "row" });
    line.append(makeElement("th", row.label, { scope: "row" }));
    const makeReader = (part) => (frame) => part.values[row.fixed ? 0 : frame];
    const add = (path, read) => {
      const cell = new NumberCell(path, read, row, missing);
      this.cells.push(cell);
      line.append(cell.element);
    };
    if (row.parts.length === 1) {
      line.append(makeElement("td"), makeElement("td"), makeElement("td"));
      add(row.path, makeReader(row.parts[0]));
    } else {
      for (const part of row.parts) add(`${row.path}.${part.name}`, makeReader(part));
      if (row.sized) add(row.path, (frame) => norm(row.parts.map((part) => makeReader(part)(frame))));
      else line.append(makeElement("td"));
    }
    line.append(makeElement("td", formatUnit(row.unit), { class: "unit" }));
    return line;
  }

  /** Add the loads of a section; a run of cuts shows the chosen cut, and the smallest and largest value of all cuts. */
  addSection(section, number) {
    const body = makeElement("tbody", "", { "data-kind": "sections" });
    if (number === 0) addHeading(body, this.data.cutting.heading, "heading", this.data.cutting.note);
    this.sectionNotes.set(section, addHeading(body, section.name, "group", section.note));
    for (const load of section.loads) body.append(this.makeLoadRow(section, load));
    this.table.append(body);
  }

  /** Make the row of a section load at the chosen cut. */
  makeLoadRow(section, load) {
    const line = makeElement("tr", "", { class: "row" });
    line.append(makeElement("th", load.label, { scope: "row" }));
    const read = (frame) => getLoadsAlong(section, load, frame)[this.selection.getCutNumber(section)];
    const cell = new NumberCell(load.path, read, load);
    this.cells.push(cell);
    if (section.s) {
      const range = new RangeCell(section, load, this.data.length);
      this.cells.push(range);
      this.cutCells.push({ section, load, cell });
      line.append(range.element);
    } else {
      line.append(makeElement("td", "", { colspan: "3" }));
    }
    line.append(cell.element, makeElement("td", formatUnit(load.unit), { class: "unit" }));
    return line;
  }

  /** Show the numbers of a frame. @param {number} frame */
  show(frame) {
    for (const section of this.data.sections) if (section.s) this.showCutPosition(section);
    for (const { section, load, cell } of this.cutCells) {
      cell.element.dataset.path = `${load.path}.${this.selection.getCutNumber(section)}`;
    }
    for (const cell of this.cells) cell.show(frame);
    this.table.dataset.frame = String(frame);
  }

  /** Show beside the name of a section where the chosen cut is. */
  showCutPosition(section) {
    const [unit, perMetre] = this.data.length;
    const cutNumber = this.selection.getCutNumber(section);
    const side = section.side[cutNumber] ? `, ${section.side[cutNumber]} the load there` : "";
    const place = `s = ${formatShort(section.s[cutNumber] * perMetre)} ${unit}`;
    this.sectionNotes.get(section).textContent = `${section.note}; value: at ${place}${side}`;
  }
}

/**
 * Let the tabs choose which tables are shown.
 * @param {NumberTable} table @param {() => void} redraw @param {string} [first] the tab that is shown at first
 * @returns {() => string} the tab that is chosen
 */
export function listenToTabs(table, redraw, first = TABS[0]) {
  let current = first;
  const choose = (chosen) => {
    current = chosen;
    for (const name of TABS) findElement(`tab-${name}`).setAttribute("aria-pressed", String(name === chosen));
    findElement("summary").hidden = chosen !== "summary";
    findElement("numbers").hidden = findElement("caption").hidden = chosen === "summary";
    if (chosen !== "summary") table.showKind(chosen);
    redraw();
  };
  for (const name of TABS) findElement(`tab-${name}`).addEventListener("click", () => choose(name));
  for (const name of ["joints", "sections"]) findElement(`tab-${name}`).hidden = !table.hasKind(name);
  choose(findElement(`tab-${first}`).hidden ? TABS[0] : first);
  return () => current;
}
