/** @file The controls of the curves: which are drawn, over what, and whether with the envelope of all load cases. */

import { peakOf } from "./courses.js";
import { PENS } from "./curve.js";
import { findElement, fill, makeElement } from "./elements.js";

/** Which curves; a click into them goes to the frame there. @param {() => import("./curve.js").Panel|null} panel */
export function listenToCurve(chosen, player, changed, panel) {
  const select = findElement("path");
  fill(select, chosen.courses.map((course) => [course.path, course.label]));
  const offer = () => {
    fill(findElement("more"), [["", "…"], ...chosen.others.map((course) => [course.path, course.label])]);
    findElement("more").disabled = !chosen.others.length || chosen.curves.length >= PENS.length;
    const chips = chosen.curves.slice(1).map((path, k) => {
      const { label } = chosen.courses.find((course) => course.path === path);
      const chip = makeElement("button", `${label} ×`, { type: "button", class: "chip" });
      chip.style.borderLeftColor = `var(--${PENS[(k + 1) % PENS.length][0]})`;
      chip.addEventListener("click", () => {
        chosen.curves = chosen.curves.filter((other) => other !== path);
        offer();
      });
      return chip;
    });
    findElement("added").replaceChildren(...chips);
    changed();
  };
  const begin = () => {
    if (chosen.curves.length) select.value = chosen.curves[0];
    offer();
  };
  const show = (path) => {
    chosen.setCourse(path);
    begin();
  };
  select.addEventListener("change", () => show(select.value));
  findElement("more").addEventListener("change", () => {
    if (findElement("more").value) chosen.curves.push(findElement("more").value);
    offer();
  });
  fill(findElement("across"), chosen.axes.map((axis, k) => [String(k), axis.label]));
  findElement("across").value = String(chosen.axes.indexOf(chosen.axis));
  findElement("acrosslabel").hidden = chosen.axes.length < 2;
  findElement("across").addEventListener("change", () => {
    chosen.axis = chosen.axes[Number(findElement("across").value)];
    changed();
  });
  const go = (highest) => () => player.halt(Math.max(0, peakOf(chosen.shownCourses[0], highest)));
  findElement("lowest").addEventListener("click", go(false));
  findElement("highest").addEventListener("click", go(true));
  const canvas = findElement("curve");
  const follow = (event) => {
    if (event.buttons && panel()) player.halt(panel().frame(event.offsetX));
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    follow(event);
  });
  canvas.addEventListener("pointermove", follow);
  if (!chosen.curves.length) chosen.setCourse(chosen.findLargestCourse());
  begin();
  if (!chosen.courses.length) findElement("over").hidden = true;
  return show;
}

/** Whether the envelope of all load cases is drawn. @param {boolean} some whether there are several */
export function listenToBand(chosen, changed, some) {
  findElement("bandlabel").hidden = !some;
  findElement("band").checked = chosen.band;
  findElement("band").addEventListener("change", () => {
    chosen.band = findElement("band").checked;
    changed();
  });
}
