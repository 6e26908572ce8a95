/** @file The page: reads its data, shows the frame of the greatest load, and draws anew whatever changes. */

import { cloudOf, coverOf } from "./cloud.js";
import { coloursNow } from "./colours.js";
import { Chosen, listenToCurve, listenToDrawn, listenToSections, listenToTime, listenToView } from "./controls.js";
import { drawCurve } from "./curve.js";
import { readData } from "./data.js";
import { instant, short, written } from "./digits.js";
import { by, made } from "./elements.js";
import { LabelList } from "./labels.js";
import { Player } from "./player.js";
import { drawMachine } from "./stage.js";
import { SummaryTable } from "./summary.js";
import { NumberTable } from "./table.js";
import { listenToCases, listenToTabs, numberOf } from "./tabs.js";
import { View } from "./view.js";

const AT_ONCE = 400; // cells of the table that are written at every image while the machine plays
const PAUSE = 0.25; // ms for each cell beyond these until they are written again

/** What is to be known of the run, below; above only that there is something. */
function tellRun(data) {
  const notes = `${data.alerts} ${data.alerts === 1 ? "note" : "notes"} on this run`;
  by("alert").hidden = !data.alerts;
  by("alert").textContent = notes;
  by("alert").addEventListener("click", () => (by("about").open = true));
  by("told").replaceChildren(...data.told.map((sentence) => made("li", sentence)));
  const lines = [...data.about, ["heun", data.version], ["file", data.file]];
  for (const [label, text] of lines) if (text) by("lines").append(made("dt", label), made("dd", text));
}

/** The signs of what is drawn, in words. */
function signsOf(chosen, data) {
  const parts = [];
  const { choice, section, load } = chosen;
  if (choice?.key.startsWith("foundation")) parts.push("Arrows: load of the machine on the ground.");
  else if (choice?.frame !== undefined) parts.push("Arrows: impulses of “from” on “to”, at their frame.");
  else if (choice) parts.push("Arrows: load of “from” on “to”; of gears, belts and ropes on the named body.");
  if (section && load) {
    const [unit, size] = data.length;
    parts.push(`Section ${section.name}: force of the far side on the near side of the cut; N > 0 is tension.`);
    const s = section.s?.[section.chosen ?? 0];
    by("place").textContent = s === undefined ? "" : `s = ${short(s * size)} ${unit}`;
  }
  return parts.join(" ");
}

/** The instant in words. */
function tellInstant(data, player, crank) {
  const { time, count } = data;
  const span = time[count - 1] - time[0];
  const text = `t = ${instant(time[player.frame], span)} s`;
  const turn = crank ? `  ·  ${crank.label} ${crank.values[player.frame].toFixed(1).replace("-", "−")}°` : "";
  const output = by("instant");
  output.textContent = count > 1 ? `${text}${turn}` : `${text}  (one instant)`;
  output.title = `frame ${player.frame + 1} of ${count}`;
  output.dataset.value = String(time[player.frame]);
  by("time").value = String(player.frame);
  by("time").setAttribute("aria-valuetext", text);
  by("play").textContent = player.playing ? "Pause" : "Play";
  by("play").setAttribute("aria-pressed", String(player.playing));
}

/** What the curve shows at this frame, for those who do not see it. */
function tellCurve(course, frame, over) {
  const low = written(course.low[frame], course.style);
  const high = written(course.high[frame], course.style);
  const value = course.low === course.high ? low : `${low} to ${high}`;
  by("curve").setAttribute("aria-label", `${course.label} over ${over}; now ${value} ${course.unit}`);
}

/** Call `follow` with the colours whenever the page turns dark or light. */
function listenToColours(follow) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => follow(coloursNow()));
}

/** Begin with the data of a load case. */
function begin({ data, cases }, run) {
  data.scene.cloud = cloudOf(data.scene, data.count);
  data.scene.cover = coverOf(data.scene);
  let [waiting, last, panel] = [false, 0, null];
  const colours = { now: coloursNow() };
  const labels = { machine: new LabelList(), curve: new LabelList() };
  const changed = () => {
    if (!waiting) requestAnimationFrame(draw);
    waiting = true;
  };
  const player = new Player(data.time, changed);
  const view = new View(data.scene);
  const chosen = new Chosen(data, changed);
  const table = new NumberTable(by("numbers"), data);
  const crank = chosen.axes[1] ?? null;
  let show = () => {};
  const summary = new SummaryTable(by("summary"), data, crank, (frame, path) => {
    if (chosen.courses.some((course) => course.path === path)) show(path);
    player.halt(frame);
  });

  function draw() {
    waiting = false;
    const { frame, share } = player;
    const shown = { frame, share, ...chosen.shown };
    drawMachine(by("machine"), data, view, shown, colours.now, labels.machine);
    const courses = chosen.shownCourses;
    if (data.count > 1 && courses.length) {
      panel = drawCurve(by("curve"), data, courses, chosen.axis, frame, colours.now, labels.curve);
      tellCurve(courses[0], frame, chosen.axis.label);
    }
    const now = performance.now();
    if (!player.playing || now - last > PAUSE * (table.cells.length - AT_ONCE)) {
      last = now;
      table.show(frame);
      by("signs").textContent = signsOf(chosen, data);
      by("machine").setAttribute("aria-label", `${data.title}, at ${instant(data.time[frame], 0)} s`);
    }
    summary.show(frame);
    tellInstant(data, player, crank);
    document.documentElement.dataset.frame = String(frame);
  }

  tellRun(data);
  by("caption").textContent = data.count > 1 ? "Values at this frame" : "Values at this instant";
  listenToCases(cases, run);
  listenToView(view, player, changed);
  listenToTime(data, player);
  listenToDrawn(chosen, player, changed);
  listenToSections(chosen, changed);
  listenToTabs(table, changed);
  show = listenToCurve(chosen, player, changed, () => panel);
  listenToColours((now) => {
    colours.now = now;
    changed();
  });
  new ResizeObserver(changed).observe(by("machine"));
  player.show(numberOf("frame", data.worst));
  draw();
}

if (typeof DecompressionStream === "undefined") {
  by("old").hidden = false;
} else {
  const run = numberOf("case", 0);
  readData(by("data").textContent, run).then((found) => begin(found, run));
}
