/** @file The tables beside the machine: the summary first, then those of joints, of sections, and all of them. */

import { by } from "./elements.js";

const TABS = ["summary", "joints", "sections", "all"];

/** Let the tabs choose what is shown. @param {import("./table.js").NumberTable} table @param {() => void} changed */
export function listenToTabs(table, changed) {
  const choose = (chosen) => {
    for (const name of TABS) by(`tab-${name}`).setAttribute("aria-pressed", String(name === chosen));
    by("summary").hidden = chosen !== "summary";
    by("numbers").hidden = by("caption").hidden = chosen === "summary";
    if (chosen !== "summary") table.choose(chosen);
    changed();
  };
  for (const name of TABS) by(`tab-${name}`).addEventListener("click", () => choose(name));
  for (const name of ["joints", "sections"]) by(`tab-${name}`).hidden = !table.has(name);
  choose("summary");
}

/** Let the load case be chosen; the page is read anew with it. @param {string[]} cases @param {number} run */
export function listenToCases(cases, run) {
  const select = by("case");
  by("caselabel").hidden = cases.length < 2 && !cases[0];
  select.replaceChildren(...cases.map((name, k) => new Option(name || "base", String(k))));
  select.value = String(run);
  select.disabled = cases.length < 2;
  select.addEventListener("change", () => {
    location.hash = `case=${select.value}`;
    location.reload();
  });
}

/** A number of the page's address, behind the #. @param {string} name @param {number} usual */
export function numberOf(name, usual) {
  const found = new URLSearchParams(location.hash.slice(1)).get(name);
  return found !== null && Number.isFinite(Number(found)) ? Number(found) : usual;
}
