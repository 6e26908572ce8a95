/** @file Numbers over the frames: what curves can be drawn, each as a lowest and a highest value at every frame. */

import { along } from "./loads.js";

/**
 * @typedef {object} Course
 * @property {string} path of the number @property {string} label what it is called @property {string} unit shown
 * @property {import("./digits.js").Style} style of its digits
 * @property {Float64Array} low in the unit shown @property {Float64Array} high the same, but of a series of cuts
 */

/** @param {object} row @param {number} count */
function ofRow(row, count) {
  const whole = (pick) => {
    const values = new Float64Array(count);
    for (let k = 0; k < count; k += 1) values[k] = pick(k) * row.size;
    return values;
  };
  const course = (path, label, pick) => {
    const make = () => {
      const values = whole(pick);
      return { path, label, unit: row.unit, style: row.style, low: values, high: values };
    };
    return { path, label, make };
  };
  const parts = row.parts;
  if (parts.length === 1) return [course(row.path, row.path, (k) => parts[0].values[k])];
  if (!row.sized)
    return parts.map((part) => course(`${row.path}.${part.name}`, `${row.path}.${part.name}`, (k) => part.values[k]));
  const size = course(row.path, `${row.path} (magnitude)`, (k) => Math.hypot(...parts.map((part) => part.values[k])));
  return [
    size,
    ...parts.map((part) => course(`${row.path}.${part.name}`, `${row.path}.${part.name}`, (k) => part.values[k])),
  ];
}

/** @param {object} section @param {object} load @param {number} count */
function ofLoad(section, load, count) {
  const make = () => {
    if (!section.s) {
      const values = load.values.map((value) => value * load.size);
      return { path: load.path, label: load.path, unit: load.unit, style: load.style, low: values, high: values };
    }
    const low = new Float64Array(count);
    const high = new Float64Array(count);
    for (let k = 0; k < count; k += 1) {
      const values = [...along(section, load, k)].filter((value) => !Number.isNaN(value));
      low[k] = values.length ? Math.min(...values) * load.size : NaN;
      high[k] = values.length ? Math.max(...values) * load.size : NaN;
    }
    return { path: load.path, label: load.path, unit: load.unit, style: load.style, low, high };
  };
  return { path: load.path, label: section.s ? `${load.path} (min, max)` : load.path, make };
}

/** All curves there are; each is made when it is asked for. @param {object} data */
export function coursesOf(data) {
  const rows = data.blocks.flatMap((block) => block.groups.flatMap((group) => group.rows));
  return [
    ...rows.flatMap((row) => ofRow(row, data.count)),
    ...data.sections.flatMap((section) => section.loads.map((load) => ofLoad(section, load, data.count))),
  ];
}

/** The frame of the lowest or of the highest value. @param {Course} course @param {boolean} highest */
export function peakOf(course, highest) {
  const values = highest ? course.high : course.low;
  let best = -1;
  for (let k = 0; k < values.length; k += 1) {
    if (Number.isNaN(values[k])) continue;
    if (best < 0 || (highest ? values[k] > values[best] : values[k] < values[best])) best = k;
  }
  return best;
}
