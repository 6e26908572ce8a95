/** @file The tabs of the tables, the choice of the load case, and the numbers in the page's address. */

import { findElement } from "./elements.js";

const TABS = ["summary", "joints", "sections", "all"];

/**
 * Let the tabs choose which tables are shown.
 * @param {import("./table.js").NumberTable} table @param {() => void} changed @param {string} first shown at first
 * @returns {() => string} the tab that is chosen
 */
export function listenToTabs(table, changed, first = TABS[0]) {
  let current = first;
  const choose = (chosen) => {
    current = chosen;
    for (const name of TABS) findElement(`tab-${name}`).setAttribute("aria-pressed", String(name === chosen));
    findElement("summary").hidden = chosen !== "summary";
    findElement("numbers").hidden = findElement("caption").hidden = chosen === "summary";
    if (chosen !== "summary") table.showKind(chosen);
    changed();
  };
  for (const name of TABS) findElement(`tab-${name}`).addEventListener("click", () => choose(name));
  for (const name of ["joints", "sections"]) findElement(`tab-${name}`).hidden = !table.hasKind(name);
  choose(findElement(`tab-${first}`).hidden ? TABS[0] : first);
  return () => current;
}

/** Format the name of a load case. @param {{case: string}} data */
export function formatCaseName(data) {
  return data.case.replaceAll("_", " ") || "base";
}

/**
 * Let the user choose the load case.
 * @param {import("./data.js").CaseData[]} runs @param {number} run @param {(run: number) => void} change
 */
export function listenToCases(runs, run, change) {
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
export function readAddressNumber(name, fallback, count) {
  const found = new URLSearchParams(location.hash.slice(1)).get(name);
  if (found === null || !Number.isFinite(Number(found))) return fallback;
  return Math.min(count - 1, Math.max(0, Math.round(Number(found))));
}
