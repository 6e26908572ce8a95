/** @file The page: reads its data, shows the frame of the greatest load, and draws anew whatever changes. */

import { cloudOf, coverOf } from "./cloud.js";
import { coloursNow } from "./colours.js";
import { Chosen, listenToDrawn, listenToSections, listenToTime, listenToView } from "./controls.js";
import { drawCurve } from "./curve.js";
import { listenToBand, listenToCurve } from "./curve_controls.js";
import { prepared, readData } from "./data.js";
import { instant, formatShort, formatNumber } from "./digits.js";
import { findElement, makeElement } from "./elements.js";
import { envelopeOf } from "./envelope.js";
import { LabelList } from "./labels.js";
import { Player } from "./player.js";
import { drawMachine } from "./stage.js";
import { SummaryTable } from "./summary.js";
import { NumberTable } from "./table.js";
import { listenToCases, listenToTabs, nameOf, numberOf } from "./tabs.js";
import { View } from "./view.js";

const AT_ONCE = 400; // cells of the table that are written at every image while the machine plays
const PAUSE = 0.25; // ms for each cell beyond these until they are written again

/** What is to be known of the run, below; above only that there is something. */
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

/** The signs of what is drawn, in words. */
function describeSigns(chosen, data) {
  const parts = [];
  const { choice, section, load } = chosen;
  if (choice?.key.startsWith("foundation")) parts.push("Arrows: load of the machine on the ground.");
  else if (choice?.frame !== undefined) parts.push("Arrows: impulses of “from” on “to”, at their frame.");
  else if (choice) parts.push("Arrows: load of “from” on “to”; of gears, belts and ropes on the named body.");
  if (section && load) {
    const [unit, size] = data.length;
    parts.push(`Section ${section.name}: force of the far side on the near side of the cut; N > 0 is tension.`);
    const s = section.s?.[section.chosen ?? 0];
    findElement("place").textContent = s === undefined ? "" : `s = ${formatShort(s * size)} ${unit}`;
  }
  return parts.join(" ");
}

/** The instant in words. */
function showInstant(data, player, crank) {
  const { time, count } = data;
  const span = time[count - 1] - time[0];
  const text = `t = ${instant(time[player.frame], span)} s`;
  const turn = crank ? `  ·  ${crank.label} ${crank.values[player.frame].toFixed(1).replace("-", "−")}°` : "";
  const output = findElement("instant");
  output.textContent = count > 1 ? `${text}${turn}` : `${text}  (one instant)`;
  output.title = `frame ${player.frame + 1} of ${count}`;
  output.dataset.value = String(time[player.frame]);
  findElement("time").value = String(player.frame);
  findElement("time").setAttribute("aria-valuetext", text);
  findElement("play").textContent = player.playing ? "Pause" : "Play";
  findElement("play").setAttribute("aria-pressed", String(player.playing));
}

/** What the curve shows at this frame, for those who do not see it. */
function showCurve(course, frame, over) {
  const low = formatNumber(course.low[frame], course.style);
  const high = formatNumber(course.high[frame], course.style);
  const value = course.low === course.high ? low : `${low} to ${high}`;
  findElement("curve").setAttribute("aria-label", `${course.label} over ${over}; now ${value} ${course.unit}`);
}

/** Call `follow` with the colours whenever the page turns dark or light, until the signal. */
function listenToColours(follow, signal) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => follow(coloursNow()), { signal });
}

/** The envelope of the curve over all cases, made anew where another curve or axis is chosen; null: not drawn. */
function makeBandFinder(runs) {
  const names = runs.map(nameOf);
  let [key, band] = ["", null];
  return ({ band: wanted, axis }, [course]) => {
    if (!wanted || runs.length < 2 || !course) return null;
    if (key !== `${course.path} ${axis.label}`) {
      key = `${course.path} ${axis.label}`;
      band = envelopeOf(runs.map(prepared), course, axis);
      if (band) band.names = names;
    }
    return band;
  };
}

/** Which case governs the curve, as buttons that go there. @param {(run: number, frame: number) => void} go */
function showGoverning(band, course, go) {
  const key = band ? `${course.path} ${band.greatest.run} ${band.least.run}` : "";
  const bar = findElement("governing");
  if (bar.dataset.key === key) return;
  bar.dataset.key = key;
  bar.hidden = !band;
  const buttons = Object.entries(band ? { greatest: band.greatest, least: band.least } : {}).map(([word, end]) => {
    const value = `${formatNumber(end.value, course.style)} ${course.unit === "1" ? "" : course.unit}`.trim();
    const button = makeElement("button", `${word} ${value}: ${band.names[end.run]}`, { type: "button" });
    button.addEventListener("click", () => go(end.run, end.frame));
    return button;
  });
  bar.replaceChildren(makeElement("span", "Of all load cases", { class: "word" }), ...buttons);
}

/** A load case on the page, until it is left. */
class ShownCase {
  /**
   * @param {object[]} runs all cases @param {number} run the number of this one
   * @param {object} before what the case before it left
   * @param {(run: number, frame?: number) => void} change to another case
   */
  constructor(runs, run, before, change) {
    const data = prepared(runs[run]);
    data.scene.cloud ??= cloudOf(data.scene, data.count);
    data.scene.cover ??= coverOf(data.scene);
    Object.assign(this, { data, change, waiting: false, last: 0, panel: null });
    this.ended = new AbortController();
    this.colours = coloursNow();
    this.labels = { machine: new LabelList(), curve: new LabelList() };
    this.changed = () => {
      if (!this.waiting) requestAnimationFrame(() => this.draw());
      this.waiting = true;
    };
    this.player = new Player(data.time, this.changed);
    this.view = new View(data.scene);
    if (before.view) this.view.take(before.view);
    this.chosen = new Chosen(data, this.changed, before.chosen);
    this.table = new NumberTable(findElement("numbers"), data);
    this.crank = this.chosen.axes[1] ?? null;
    this.bandOf = makeBandFinder(runs);
    this.summary = new SummaryTable(findElement("summary"), data, this.crank, (frame, path) => {
      if (this.chosen.courses.some((course) => course.path === path)) this.show(path);
      this.player.halt(frame);
    });
    this.listen(before, runs.length > 1);
    this.player.show(before.frame ?? this.chosen.nearest(before.place) ?? data.worst);
    this.draw();
    if (before.playing && data.count > 1) this.player.toggle();
  }

  /** Follow the controls. */
  listen(before, hasCases) {
    const { data, player, chosen, changed } = this;
    const { signal } = this.ended;
    showRunNotes(data, signal);
    findElement("caption").textContent = data.count > 1 ? "Values at this frame" : "Values at this instant";
    listenToView(this.view, player, changed, signal);
    listenToTime(data, player, before.player);
    listenToDrawn(chosen, player, changed);
    listenToSections(chosen, changed);
    this.tab = listenToTabs(this.table, changed, before.tab);
    listenToBand(chosen, changed, hasCases && data.count > 1);
    this.show = listenToCurve(chosen, player, changed, () => this.panel);
    listenToColours((now) => {
      this.colours = now;
      changed();
    }, signal);
    this.size = new ResizeObserver(changed);
    this.size.observe(findElement("machine"));
  }

  draw() {
    this.waiting = false;
    if (this.ended.signal.aborted) return;
    const { data, player, chosen, table } = this;
    const { frame, share } = player;
    const shown = { frame, share, ...chosen.shown };
    drawMachine(findElement("machine"), data, this.view, shown, this.colours, this.labels.machine);
    this.drawCurves(frame);
    const now = performance.now();
    if (!player.playing || now - this.last > PAUSE * (table.cells.length - AT_ONCE)) {
      this.last = now;
      table.show(frame);
      findElement("signs").textContent = describeSigns(chosen, data);
      findElement("machine").setAttribute("aria-label", `${data.title}, at ${instant(data.time[frame], 0)} s`);
    }
    this.summary.show(frame);
    showInstant(data, player, this.crank);
    document.documentElement.dataset.frame = String(frame);
  }

  drawCurves(frame) {
    const courses = this.chosen.shownCourses;
    if (this.data.count < 2 || !courses.length) return;
    const { axis } = this.chosen;
    const band = this.bandOf(this.chosen, courses);
    const canvas = findElement("curve");
    this.panel = drawCurve(canvas, this.data, courses, axis, band, frame, this.colours, this.labels.curve);
    showCurve(courses[0], frame, axis.label);
    showGoverning(band, courses[0], this.change);
  }

  /** End it. @returns {object} what the next case takes over */
  leave() {
    const { view, player, chosen } = this;
    const { playing } = player;
    const place = { label: chosen.axis.label, at: chosen.axis.values[player.frame] };
    player.halt();
    this.ended.abort();
    this.size.disconnect();
    return { view, player, chosen, place, tab: this.tab(), playing };
  }
}

/** Show the load cases, each in a fresh copy of the page's main part. @param {object[]} runs */
function showCases(runs) {
  const blank = document.querySelector("main").cloneNode(true);
  let shown = null;
  const change = (run, frame) => {
    const before = shown?.leave() ?? {};
    if (shown) document.querySelector("main").replaceWith(blank.cloneNode(true));
    findElement("case").value = String(run);
    shown = new ShownCase(runs, run, Object.assign(before, { frame }), change);
  };
  const first = Math.min(numberOf("case", 0), runs.length - 1);
  listenToCases(runs, first, (run) => change(run));
  change(first, numberOf("frame", runs[first].worst));
}

if (typeof DecompressionStream === "undefined") findElement("old").hidden = false;
else readData(findElement("data").textContent).then(showCases);
