/** @file Computes the envelope of a curve over the load cases, and which case has each extreme. */

import { getAxes, getHistories, computeHistory, findPeakFrame } from "./histories.js";

/**
 * @typedef {object} Envelope
 * @property {Float64Array} values where it is known: instants or angles, ascending
 * @property {Float64Array} low @property {Float64Array} high minimum and maximum of all cases there
 * @property {{run: number, frame: number, value: number, x: number}} least @property {object} greatest of all instants
 */

/** Make the curve of a case over an axis, in a unit of the given size; null if the case lacks either. */
function makeCaseCurve(data, run, path, label, size) {
  const history = getHistories(data).find((each) => each.path === path);
  const axis = getAxes(data).find((each) => each.label === label);
  if (!history || !axis) return null;
  const made = computeHistory(history);
  const share = size / made.size;
  const low = made.low.map((value) => value * share);
  const high = made.low === made.high ? low : made.high.map((value) => value * share);
  return { run, made, x: axis.values, low, high };
}

/** Extend one side of the envelope by a curve, which is linear between its instants and ends with them. */
function extendEnvelope(curve, grid, found, values, isBeyond) {
  const { x } = curve;
  const way = x[x.length - 1] < x[0] ? -1 : 1;
  const at = (k) => (way > 0 ? k : x.length - 1 - k);
  let k = 0;
  for (let i = 0; i < grid.length; i += 1) {
    while (k + 1 < x.length && x[at(k + 1)] <= grid[i]) k += 1;
    if (grid[i] < x[at(k)] || (k + 1 === x.length && grid[i] > x[at(k)])) continue;
    const [a, b] = [at(k), at(Math.min(k + 1, x.length - 1))];
    const share = x[b] === x[a] ? 0 : (grid[i] - x[a]) / (x[b] - x[a]);
    const value = share === 0 ? values[a] : values[a] + share * (values[b] - values[a]);
    if (Number.isFinite(value) && (Number.isNaN(found[i]) || isBeyond(value, found[i]))) found[i] = value;
  }
}

/** Find the extreme of all cases, with its case and frame. */
function findExtreme(curves, highest) {
  let best = null;
  for (const { run, made, x, low, high } of curves) {
    const frame = findPeakFrame(made, highest);
    if (frame < 0) continue;
    const value = (highest ? high : low)[frame];
    if (!best || (highest ? value > best.value : value < best.value)) best = { run, frame, value, x: x[frame] };
  }
  return best;
}

/**
 * Compute the envelope of a number over all cases that have it.
 * @param {import("./data.js").CaseData[]} runs ready to be shown
 * @param {import("./histories.js").TimeHistory} history of the case that is shown
 * @param {{label: string}} axis over what @returns {Envelope|null} null where fewer than two cases have the number
 */
export function computeEnvelope(runs, history, axis) {
  const curves = runs
    .map((data, run) => makeCaseCurve(data, run, history.path, axis.label, history.size))
    .filter((curve) => curve && curve.x.length > 1);
  const greatest = findExtreme(curves, true);
  if (curves.length < 2 || !greatest) return null;
  const values = Float64Array.from(new Set(curves.flatMap(({ x }) => Array.from(x)))).sort();
  const [low, high] = [new Float64Array(values.length).fill(NaN), new Float64Array(values.length).fill(NaN)];
  for (const curve of curves) {
    extendEnvelope(curve, values, low, curve.low, (value, found) => value < found);
    extendEnvelope(curve, values, high, curve.high, (value, found) => value > found);
  }
  return { values, low, high, least: findExtreme(curves, false), greatest };
}
