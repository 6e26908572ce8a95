/** @file A load case while it is shown: its picture, curves and tables, which are drawn anew after every change. */

import { listenToDrawing, listenToSections, listenToTime, listenToView } from "./controls.js";
import { drawCurve, listenToCurve, listenToEnvelope } from "./curve.js";
import { prepareCase } from "./data.js";
import { formatInstant, formatNumber, formatShort, formatWithUnit } from "./digits.js";
import { findElement, makeElement } from "./elements.js";
import { computeEnvelope } from "./histories.js";
import { LabelList } from "./labels.js";
import { Player } from "./player.js";
import { Selection } from "./selection.js";
import { drawMachine } from "./stage.js";
import { readColours } from "./strokes.js";
import { SummaryTable } from "./summary.js";
import { listenToTabs, NumberTable } from "./table.js";
import { prepareView, View } from "./view.js";

const MAX_CELLS_AT_ONCE = 400; // cells of the table that are written at every image while the machine plays
const CELL_PAUSE = 0.25; // ms for each cell beyond these until they are written again

/** Format the name of a load case. @param {{case: string}} data */
export function formatCaseName(data) {
  return data.case.replaceAll("_", " ") || "base";
}

/** List the notes on the run at the foot of the page, and link to them at its head. */
function showRunNotes(data, signal) {
  const count = `${data.alerts} ${data.alerts === 1 ? "note" : "notes"} on this run`;
  document.title = findElement("title").textContent = data.title;
  findElement("alert").hidden = !data.alerts;
  findElement("alert").textContent = count;
  findElement("alert").addEventListener("click", () => (findElement("about").open = true), { signal });
  findElement("notes").replaceChildren(...data.notes.map((sentence) => makeElement("li", sentence)));
  const lines = [...data.about, ["heun", data.version], ["file", data.file]];
  for (const [label, text] of lines.filter((line) => line[1])) {
    findElement("lines").append(makeElement("dt", label), makeElement("dd", text));
  }
}

/** Describe the sign conventions of what is drawn. */
function describeSigns(selection) {
  const parts = [];
  const { choice, section, load } = selection;
  if (choice?.key.startsWith("foundation")) parts.push("Arrows: load of the machine on the ground.");
  else if (choice?.frame !== undefined) parts.push("Arrows: impulses of “from” on “to”, at their frame.");
  else if (choice) parts.push("Arrows: load of “from” on “to”; of gears, belts and ropes on the named body.");
  if (section && load) {
    parts.push(`Section ${section.name}: force of the far side on the near side of the cut; N > 0 is tension.`);
  }
  return parts.join(" ");
}

/** Show the position of the chosen cut along its bar. */
function showPlace(selection, [unit, perSi]) {
  const { section, load } = selection;
  const s = section && load ? section.s?.[selection.getCutNumber(section)] : undefined;
  findElement("place").textContent = s === undefined ? "" : `s = ${formatShort(s * perSi)} ${unit}`;
}

/** Show the instant as text and on the slider. */
function showInstant(data, player, crank) {
  const { time, count } = data;
  const span = time[count - 1] - time[0];
  const text = `t = ${formatInstant(time[player.frame], span)} s`;
  const angleText = crank ? `  ·  ${crank.label} ${crank.values[player.frame].toFixed(1).replace("-", "−")}°` : "";
  const output = findElement("instant");
  output.textContent = count > 1 ? `${text}${angleText}` : `${text}  (one instant)`;
  output.title = `frame ${player.frame + 1} of ${count}`;
  output.dataset.value = String(time[player.frame]);
  findElement("time").value = String(player.frame);
  findElement("time").setAttribute("aria-valuetext", text);
  findElement("play").textContent = player.playing ? "Pause" : "Play";
  findElement("play").setAttribute("aria-pressed", String(player.playing));
}

/** Describe the curve at this frame for screen readers. */
function showCurve(history, frame, axisLabel) {
  const low = formatNumber(history.low[frame], history.style);
  const high = formatNumber(history.high[frame], history.style);
  const value = history.low === history.high ? low : `${low} to ${high}`;
  findElement("curve").setAttribute("aria-label", `${history.label} over ${axisLabel}; now ${value} ${history.unit}`);
}

/** Call `listener` with the colours whenever the page turns dark or light, until the signal. */
function listenToColours(listener, signal) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => listener(readColours()), { signal });
}

/** Make the function that finds the envelope of a curve over all cases, or null; it remembers the last one. */
function makeEnvelopeFinder(runs) {
  const names = runs.map(formatCaseName);
  let [key, envelope] = ["", null];
  return ({ hasEnvelope, axis }, [history]) => {
    if (!hasEnvelope || runs.length < 2 || !history) return null;
    if (key !== `${history.path} ${axis.label}`) {
      key = `${history.path} ${axis.label}`;
      envelope = computeEnvelope(runs.map(prepareCase), history, axis);
      if (envelope) envelope.names = names;
    }
    return envelope;
  };
}

/**
 * Show which case has each extreme of the curve, as buttons that go there.
 * @param {(run: number, frame: number) => void} goTo
 */
function showGoverning(envelope, history, goTo) {
  const key = envelope ? `${history.path} ${envelope.greatest.run} ${envelope.least.run}` : "";
  const bar = findElement("governing");
  if (bar.dataset.key === key) return;
  bar.dataset.key = key;
  bar.hidden = !envelope;
  const ends = envelope ? { greatest: envelope.greatest, least: envelope.least } : {};
  const buttons = Object.entries(ends).map(([word, end]) => {
    const value = formatWithUnit(end.value, history.style, history.unit);
    const button = makeElement("button", `${word} ${value}: ${envelope.names[end.run]}`, { type: "button" });
    button.addEventListener("click", () => goTo(end.run, end.frame));
    return button;
  });
  bar.replaceChildren(makeElement("span", "Of all load cases", { class: "word" }), ...buttons);
}

/** A load case while it is shown. */
export class ShownCase {
  /**
   * @param {CaseData[]} runs all cases @param {number} run the number of this one
   * @param {PreviousCase} previous what the case before it left
   * @param {number|undefined} frame to show at first; otherwise where the case before stood, or the greatest load
   * @param {(run: number, frame?: number) => void} change to another case
   */
  constructor(runs, run, previous, frame, change) {
    this.data = prepareCase(runs[run]);
    this.hasCases = runs.length > 1;
    this.change = change;
    this.findEnvelope = makeEnvelopeFinder(runs);
    this.makeParts(previous);
    this.listen(previous);
    this.begin(previous, frame);
  }

  /** Make what shows the case. @param {PreviousCase} previous */
  makeParts(previous) {
    const { data } = this;
    prepareView(data);
    this.colours = readColours();
    this.labels = { machine: new LabelList(), curve: new LabelList() };
    this.isWaiting = false; // for the next image of the screen
    this.redraw = () => {
      if (!this.isWaiting) requestAnimationFrame(() => this.draw());
      this.isWaiting = true;
    };
    this.player = new Player(data.time, this.redraw);
    this.view = new View(data.scene);
    if (previous.view) this.view.copyFrom(previous.view);
    this.selection = new Selection(data, previous.selection);
    this.crank = this.selection.axes[1] ?? null;
    this.table = new NumberTable(findElement("numbers"), data, this.selection);
    this.lastTableTime = 0; // when its numbers were last written [ms]
    this.summary = new SummaryTable(findElement("summary"), data, this.crank, (frame, path) => {
      if (this.selection.histories.some((history) => history.path === path)) this.showHistory(path);
      this.player.halt(frame);
    });
    /** @type {Panel|null} the plot area of the curves, once they are drawn */
    this.panel = null;
  }

  /** Connect the controls; `ended` disconnects those that outlive the case. @param {PreviousCase} previous */
  listen(previous) {
    const { data, player, selection, redraw } = this;
    this.ended = new AbortController();
    const { signal } = this.ended;
    showRunNotes(data, signal);
    findElement("caption").textContent = data.count > 1 ? "Values at this frame" : "Values at this instant";
    listenToView(this.view, player, redraw, signal);
    listenToTime(data, player, previous.player);
    listenToDrawing(selection, player, redraw);
    listenToSections(selection, redraw);
    this.getTab = listenToTabs(this.table, redraw, previous.tab);
    listenToEnvelope(selection, redraw, this.hasCases && data.count > 1);
    this.showHistory = listenToCurve(selection, player, redraw, () => this.panel);
    listenToColours((colours) => {
      this.colours = colours;
      redraw();
    }, signal);
    this.resizeObserver = new ResizeObserver(redraw);
    this.resizeObserver.observe(findElement("machine"));
  }

  /** Show the first frame, and play if the case before played. */
  begin(previous, frame) {
    this.player.show(frame ?? this.selection.findNearestFrame(previous.place) ?? this.data.worst);
    this.draw();
    if (previous.playing && this.data.count > 1) this.player.toggle();
  }

  /** Draw all parts at the frame of the player. */
  draw() {
    this.isWaiting = false;
    if (this.ended.signal.aborted) return;
    const { data, player } = this;
    const { frame, share } = player;
    const options = { frame, share, ...this.selection.drawOptions };
    drawMachine(findElement("machine"), data, this.view, options, this.colours, this.labels.machine);
    this.drawCurves(frame);
    if (this.isTableDue()) this.writeTable(frame);
    this.summary.show(frame);
    showInstant(data, player, this.crank);
    document.documentElement.dataset.frame = String(frame);
  }

  /** Whether the table is to be written at this image: while the machine plays, a large one is written more rarely. */
  isTableDue() {
    const pause = CELL_PAUSE * (this.table.cells.length - MAX_CELLS_AT_ONCE);
    return !this.player.playing || performance.now() - this.lastTableTime > pause;
  }

  /** Write the numbers of a frame, and what the arrows and the section show. */
  writeTable(frame) {
    const { data, selection } = this;
    this.lastTableTime = performance.now();
    this.table.show(frame);
    findElement("signs").textContent = describeSigns(selection);
    showPlace(selection, data.length);
    findElement("machine").setAttribute("aria-label", `${data.title}, at ${formatInstant(data.time[frame], 0)} s`);
  }

  /** Draw the curves with their envelope, if there are any. */
  drawCurves(frame) {
    const { axis, shownHistories: histories } = this.selection;
    if (this.data.count < 2 || !histories.length) return;
    const envelope = this.findEnvelope(this.selection, histories);
    const canvas = findElement("curve");
    this.panel = drawCurve(canvas, this.data, histories, axis, envelope, frame, this.colours, this.labels.curve);
    showCurve(histories[0], frame, axis.label);
    showGoverning(envelope, histories[0], this.change);
  }

  /** Leave the case. @returns {PreviousCase} what the next case takes over */
  leave() {
    const { view, player, selection } = this;
    const { playing } = player;
    const place = { label: selection.axis.label, value: selection.axis.values[player.frame] };
    player.halt();
    this.ended.abort();
    this.resizeObserver.disconnect();
    return { view, player, selection, place, tab: this.getTab(), playing };
  }
}
