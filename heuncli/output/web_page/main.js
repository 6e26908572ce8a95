/** @file The page: reads its data and shows a load case; starts another one when the user changes to it. */

import { readData } from "./data.js";
import { findElement } from "./elements.js";
import { formatCaseName, ShownCase } from "./shown_case.js";

/**
 * Let the user choose the load case.
 * @param {CaseData[]} runs @param {number} run @param {(run: number) => void} change
 */
function listenToCases(runs, run, change) {
  const select = findElement("case");
  findElement("caselabel").hidden = runs.length < 2 && !runs[0].case;
  select.replaceChildren(...runs.map((data, k) => new Option(formatCaseName(data), String(k))));
  select.value = String(run);
  select.disabled = runs.length < 2;
  select.addEventListener("change", () => change(Number(select.value)));
}

/**
 * Read the number of a frame or a case from the page's address, as in #frame=12: a whole one that there is.
 * @param {string} name @param {number} fallback @param {number} count how many there are
 */
function readAddressNumber(name, fallback, count) {
  const found = new URLSearchParams(location.hash.slice(1)).get(name);
  if (found === null || !Number.isFinite(Number(found))) return fallback;
  return Math.min(count - 1, Math.max(0, Math.round(Number(found))));
}

/** Show the load cases, each in a fresh copy of the page's main part. @param {CaseData[]} runs */
function showCases(runs) {
  const blank = document.querySelector("main").cloneNode(true);
  /** @type {ShownCase|null} */
  let shown = null;
  const change = (run, frame) => {
    const previous = shown?.leave() ?? {};
    if (shown) document.querySelector("main").replaceWith(blank.cloneNode(true));
    findElement("case").value = String(run);
    shown = new ShownCase(runs, run, previous, frame, change);
  };
  const first = readAddressNumber("case", 0, runs.length);
  listenToCases(runs, first, (run) => change(run));
  change(first, readAddressNumber("frame", runs[first].worst, runs[first].count));
}

// a browser that cannot inflate the data shows a note instead
if (typeof DecompressionStream === "undefined") findElement("old").hidden = false;
else readData(findElement("data").textContent).then(showCases);
