/** @file Time histories: the numbers that can be drawn as curves, and the axes over which they can be drawn. */

import { getLoadsAlong } from "./loads.js";
import { norm } from "./vectors.js";

const FULL_TURN = 2 * Math.PI * 0.98; // rad: an angle that goes as far and never back is that of a crank
const DEGREES = 180 / Math.PI;

/**
 * @typedef {object} TimeHistory
 * @property {string} path of the number @property {string} label what it is called @property {string} unit shown
 * @property {import("./digits.js").Style} style of its digits @property {number} size of the unit, in SI
 * @property {Float64Array} low in the unit shown @property {Float64Array} high the same, but of a series of cuts
 */

/**
 * Make the histories of a row: its magnitude and its components.
 * @param {import("./data.js").Row} row @param {number} count frames
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

/** Get all histories; each computes its numbers when it is first drawn. @param {import("./data.js").CaseData} data */
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
