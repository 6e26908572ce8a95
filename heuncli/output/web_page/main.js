/** @file The page: reads its data, shows the first frame, and draws anew whatever changes. */

import { coloursNow } from "./colours.js";
import { Chosen, listenToCurve, listenToDrawn, listenToSections, listenToTime, listenToView } from "./controls.js";
import { drawCurve } from "./curve.js";
import { readData } from "./data.js";
import { instant, short, written } from "./digits.js";
import { by, made } from "./elements.js";
import { Player } from "./player.js";
import { drawMachine } from "./stage.js";
import { NumberTable } from "./table.js";
import { View } from "./view.js";

const AT_ONCE = 400; // cells of the table that are written at every image while the machine plays
const PAUSE = 0.25; // ms for each cell beyond these until they are written again

const COUPLED = "Couplings: force on the named body, along its line of action.";

/** What stands above and below: the run, what is to be known of it. */
function tellRun(data) {
  by("run").textContent = `heun ${data.version}${data.file ? `  ·  ${data.file}` : ""}`;
  const accuracy = data.about.find(([label]) => label === "accuracy");
  by("accuracy").textContent = accuracy ? `Stated accuracy: ${accuracy[1]}.` : "";
  by("told").replaceChildren(...data.told.map((sentence) => made("li", sentence)));
  for (const [label, text] of data.about) by("lines").append(made("dt", label), made("dd", text));
}

/** The signs of what is drawn, in words. */
function signsOf(chosen, data) {
  const parts = [];
  const { choice, section, load } = chosen;
  if (choice) {
    const ofCouplings = choice.rows.some((row) => row.coupling);
    if (choice.key.startsWith("couplings")) parts.push(COUPLED);
    else if (choice.key.startsWith("foundation")) parts.push("Arrows: load of the machine on the ground.");
    else if (choice.frame !== undefined)
      parts.push("Arrows: impulses of “from” on “to”, shown at the frame of the impulse.");
    else parts.push("Arrows: reaction of “from” on “to”, at the “to” point.", ofCouplings ? COUPLED : "");
  }
  if (section && load) {
    const [unit, size] = data.length;
    parts.push(
      `Section ${section.name}: force of the far side on the near side of the cut; N > 0 is tension.`,
    );
    const s = section.s?.[section.chosen ?? 0];
    by("place").textContent = s === undefined ? "" : `s = ${short(s * size)} ${unit}`;
  }
  return parts.join(" ");
}

/** The instant in words. */
function tellInstant(data, player) {
  const { time, count } = data;
  const span = time[count - 1] - time[0];
  const text = `t = ${instant(time[player.frame], span)} s`;
  const output = by("instant");
  output.textContent = count > 1 ? `${text}  (frame ${player.frame + 1} of ${count})` : `${text}  (one instant)`;
  output.dataset.value = String(time[player.frame]);
  by("time").value = String(player.frame);
  by("time").setAttribute("aria-valuetext", text);
  by("play").textContent = player.playing ? "Pause" : "Play";
  by("play").setAttribute("aria-pressed", String(player.playing));
}

/** What the curve shows at this frame, for those who do not see it. */
function tellCurve(course, frame) {
  const low = written(course.low[frame], course.style);
  const high = written(course.high[frame], course.style);
  const value = course.low === course.high ? low : `${low} to ${high}`;
  by("curve").setAttribute("aria-label", `${course.label} over time; now ${value} ${course.unit}`);
}

/** Begin. */
function begin() {
  const data = readData(by("data").textContent);
  let waiting = false;
  let last = 0;
  let panel = null;
  const colours = { now: coloursNow() };
  const changed = () => {
    if (!waiting) requestAnimationFrame(draw);
    waiting = true;
  };
  const player = new Player(data.time, changed);
  const view = new View(data.scene);
  const chosen = new Chosen(data, changed);
  const table = new NumberTable(by("numbers"), data);

  function draw() {
    waiting = false;
    const { frame, share } = player;
    const shown = { frame, share, ...chosen.shown };
    drawMachine(by("machine"), data, view, shown, colours.now);
    if (data.count > 1 && chosen.course) {
      panel = drawCurve(by("curve"), data, chosen.course, frame, colours.now);
      tellCurve(chosen.course, frame);
    }
    const now = performance.now();
    if (!player.playing || now - last > PAUSE * (table.cells.length - AT_ONCE)) {
      last = now;
      table.show(frame);
      by("signs").textContent = signsOf(chosen, data);
      by("machine").setAttribute("aria-label", `${data.title}, at ${instant(data.time[frame], 0)} s`);
    }
    tellInstant(data, player);
    document.documentElement.dataset.frame = String(frame);
  }

  tellRun(data);
  by("caption").textContent = data.count > 1 ? "Values at this frame" : "Values at this instant";
  listenToView(view, player, changed);
  listenToTime(data, player);
  listenToDrawn(chosen, player, changed);
  listenToSections(chosen, changed);
  listenToCurve(chosen, player, changed, () => panel);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    colours.now = coloursNow();
    changed();
  });
  new ResizeObserver(changed).observe(by("machine"));
  draw();
  player.show(0);
}

begin();
