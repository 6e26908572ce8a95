/** @file Time histories: the numbers that can be drawn as curves, the axes over which they can be drawn, and the
 * envelope of a number over the load cases. */

import { getLoadsAlong } from "./loads.js";
import { norm } from "./poses.js";

const FULL_TURN = 2 * Math.PI * 0.98; // rad: an angle that goes as far and never back is that of a crank
const DEGREES = 180 / Math.PI;

/**
 * Make the histories of a row: its magnitude and its components.
 * @param {Row} row @param {number} count frames
 */
function makeRowHistories(row, count) {
  const history = (path, label, pick) => {
    const make = () => {
      const values = new Float64Array(count);
      for (let k = 0; k < count; k += 1) values[k] = pick(k) * row.size;
      return { path, label, unit: row.unit, size: row.size, style: row.style, low: values, high: values };
    };
    return { path, label, unit: row.unit, make };
  };
  const { parts } = row;
  if (parts.length === 1) return [history(row.path, row.caption, (k) => parts[0].values[k])];
  const components = parts.map((part) => history(`${row.path}.${part.name}`, part.caption, (k) => part.values[k]));
  if (!row.sized) return components;
  return [history(row.path, row.caption, (k) => norm(parts.map((part) => part.values[k]))), ...components];
}

/** Make the history of a section load: over a run of cuts it has a smallest and a largest value. */
function makeLoadHistory(section, load, count) {
  const label = section.s ? `${load.caption}, least and greatest` : load.caption;
  const make = () => {
    const low = new Float64Array(count);
    const high = new Float64Array(count);
    for (let k = 0; k < count; k += 1) {
      const values = [...getLoadsAlong(section, load, k)].filter((value) => !Number.isNaN(value));
      low[k] = values.length ? Math.min(...values) * load.size : NaN;
      high[k] = values.length ? Math.max(...values) * load.size : NaN;
    }
    const { path, unit, size, style } = load;
    return { path, label, unit, size, style, low, high: section.s ? high : low };
  };
  return { path: load.path, label, unit: load.unit, make };
}

/** Get all histories; each computes its numbers when it is first drawn. @param {CaseData} data */
export function getHistories(data) {
  data.histories ??= collectHistories(data);
  return data.histories;
}

/** Compute the numbers of a history, once. @returns {TimeHistory} */
export function computeHistory(history) {
  history.made ??= history.make();
  return history.made;
}

function collectHistories(data) {
  const rows = data.blocks.flatMap((block) => block.groups.flatMap((group) => group.rows));
  return [
    ...rows.flatMap((row) => makeRowHistories(row, data.count)),
    ...data.sections.flatMap((section) => section.loads.map((load) => makeLoadHistory(section, load, data.count))),
  ];
}

/**
 * Get the axes of curves: time, and the angle of each joint that turns fully round in one direction.
 * @returns {{label: string, values: Float64Array}[]}
 */
export function getAxes(data) {
  data.axes ??= findAxes(data);
  return data.axes;
}

function findAxes(data) {
  const cranks = [...data.rows.values()].filter((row) => /^coordinates\..*\.angle$/.test(row.path)).filter((row) => {
    const { values } = row.parts[0];
    const direction = Math.sign(values[values.length - 1] - values[0]);
    const turns = Math.abs(values[values.length - 1] - values[0]) >= FULL_TURN;
    return turns && values.every((value, k) => k === 0 || (value - values[k - 1]) * direction >= 0);
  });
  return [
    { label: "time", unit: "s", values: data.time },
    ...cranks.map(({ caption, parts }) => {
      const values = parts[0].values.map((v) => v * DEGREES);
      return { label: caption.replace(/, angle$/, " angle"), unit: "°", values };
    }),
  ];
}

/**
 * Find the frame of the lowest or of the highest value; -1 if all are open.
 * @param {TimeHistory} history @param {boolean} highest
 */
export function findPeakFrame(history, highest) {
  const values = highest ? history.high : history.low;
  let best = -1;
  for (let k = 0; k < values.length; k += 1) {
    if (Number.isNaN(values[k])) continue;
    if (best < 0 || (highest ? values[k] > values[best] : values[k] < values[best])) best = k;
  }
  return best;
}

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
  const isRising = x[x.length - 1] >= x[0];
  const at = (k) => (isRising ? k : x.length - 1 - k);
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
 * @param {CaseData[]} runs ready to be shown
 * @param {TimeHistory} history of the case that is shown
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
