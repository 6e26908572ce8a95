/** @file The controls of the curves: which are drawn, over which axis, with or without the envelope of load cases. */

import { listenToCheckBox } from "./controls.js";
import { findPeakFrame } from "./histories.js";
import { PENS } from "./curve.js";
import { findElement, fillSelect, makeElement } from "./elements.js";

/**
 * Let the user choose curves; a click into the plot goes to the frame there.
 * @param {() => import("./curve.js").Panel|null} panel
 */
export function listenToCurve(selection, player, redraw, panel) {
  const select = findElement("path");
  fillSelect(select, selection.histories.map((history) => [history.path, history.label]));
  const showAddable = () => {
    const addable = selection.addableHistories.map((history) => [history.path, history.label]);
    fillSelect(findElement("more"), [["", "…"], ...addable]);
    findElement("more").disabled = !addable.length || selection.curves.length >= PENS.length;
    const chips = selection.curves.slice(1).map((path, k) => {
      const { label } = selection.histories.find((history) => history.path === path);
      const chip = makeElement("button", `${label} ×`, { type: "button", class: "chip" });
      chip.style.borderLeftColor = `var(--${PENS[(k + 1) % PENS.length][0]})`;
      chip.addEventListener("click", () => {
        selection.curves = selection.curves.filter((other) => other !== path);
        showAddable();
      });
      return chip;
    });
    findElement("added").replaceChildren(...chips);
    redraw();
  };
  const showFirst = () => {
    if (selection.curves.length) select.value = selection.curves[0];
    showAddable();
  };
  const show = (path) => {
    selection.showHistory(path);
    showFirst();
  };
  select.addEventListener("change", () => show(select.value));
  findElement("more").addEventListener("change", () => {
    if (findElement("more").value) selection.curves.push(findElement("more").value);
    showAddable();
  });
  fillSelect(findElement("across"), selection.axes.map((axis, k) => [String(k), axis.label]));
  findElement("across").value = String(selection.axes.indexOf(selection.axis));
  findElement("acrosslabel").hidden = selection.axes.length < 2;
  findElement("across").addEventListener("change", () => {
    selection.axis = selection.axes[Number(findElement("across").value)];
    redraw();
  });
  const goToPeak = (highest) => () => player.halt(Math.max(0, findPeakFrame(selection.shownHistories[0], highest)));
  findElement("lowest").addEventListener("click", goToPeak(false));
  findElement("highest").addEventListener("click", goToPeak(true));
  const canvas = findElement("curve");
  const goToPointer = (event) => {
    if (event.buttons && panel()) player.halt(panel().findFrame(event.offsetX));
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    goToPointer(event);
  });
  canvas.addEventListener("pointermove", goToPointer);
  if (!selection.curves.length) selection.showHistory(selection.findLargestHistory());
  showFirst();
  if (!selection.histories.length) findElement("over").hidden = true;
  return show;
}

/** Let the user show the envelope of all load cases. @param {boolean} hasCases whether there are several */
export function listenToEnvelope(selection, redraw, hasCases) {
  findElement("bandlabel").hidden = !hasCases;
  listenToCheckBox("band", selection, "hasEnvelope", redraw);
}
