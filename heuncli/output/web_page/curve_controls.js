/** @file The controls of the curves: which are drawn, over what, and whether with the envelope of all load cases. */

import { peakOf } from "./courses.js";
import { PENS } from "./curve.js";
import { by, fill, made } from "./elements.js";

/** Which curves; a click into them goes to the frame there. @param {() => import("./curve.js").Panel|null} panel */
export function listenToCurve(chosen, player, changed, panel) {
  const select = by("path");
  fill(select, chosen.courses.map((course) => [course.path, course.label]));
  const offer = () => {
    fill(by("more"), [["", "…"], ...chosen.others.map((course) => [course.path, course.label])]);
    by("more").disabled = !chosen.others.length || chosen.curves.length >= PENS.length;
    const chips = chosen.curves.slice(1).map((path, k) => {
      const { label } = chosen.courses.find((course) => course.path === path);
      const chip = made("button", `${label} ×`, { type: "button", class: "chip" });
      chip.style.borderLeftColor = `var(--${PENS[(k + 1) % PENS.length][0]})`;
      chip.addEventListener("click", () => {
        chosen.curves = chosen.curves.filter((other) => other !== path);
        offer();
      });
      return chip;
    });
    by("added").replaceChildren(...chips);
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
  by("more").addEventListener("change", () => {
    if (by("more").value) chosen.curves.push(by("more").value);
    offer();
  });
  fill(by("across"), chosen.axes.map((axis, k) => [String(k), axis.label]));
  by("across").value = String(chosen.axes.indexOf(chosen.axis));
  by("acrosslabel").hidden = chosen.axes.length < 2;
  by("across").addEventListener("change", () => {
    chosen.axis = chosen.axes[Number(by("across").value)];
    changed();
  });
  const go = (highest) => () => player.halt(Math.max(0, peakOf(chosen.shownCourses[0], highest)));
  by("lowest").addEventListener("click", go(false));
  by("highest").addEventListener("click", go(true));
  const canvas = by("curve");
  const follow = (event) => {
    if (event.buttons && panel()) player.halt(panel().frame(event.offsetX));
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    follow(event);
  });
  canvas.addEventListener("pointermove", follow);
  if (!chosen.curves.length) chosen.setCourse(chosen.telling());
  begin();
  if (!chosen.courses.length) by("over").hidden = true;
  return show;
}

/** Whether the envelope of all load cases is drawn. @param {boolean} some whether there are several */
export function listenToBand(chosen, changed, some) {
  by("bandlabel").hidden = !some;
  by("band").checked = chosen.band;
  by("band").addEventListener("change", () => {
    chosen.band = by("band").checked;
    changed();
  });
}
