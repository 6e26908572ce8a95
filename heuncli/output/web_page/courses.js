/** @file Numbers over the frames: what curves can be drawn, each as a lowest and a highest value at every frame. */

import { along } from "./loads.js";
import { lengthOf } from "./vectors.js";

const ROUND = 2 * Math.PI * 0.98; // rad: an angle that goes as far and never back is that of a crank
const DEGREES = 180 / Math.PI;

/**
 * @typedef {object} Course
 * @property {string} path of the number @property {string} label what it is called @property {string} unit shown
 * @property {import("./digits.js").Style} style of its digits @property {number} size of the unit, in SI
 * @property {Float64Array} low in the unit shown @property {Float64Array} high the same, but of a series of cuts
 */

/** @param {object} row @param {number} count */
function ofRow(row, count) {
  const course = (path, label, pick) => {
    const make = () => {
      const values = new Float64Array(count);
      for (let k = 0; k < count; k += 1) values[k] = pick(k) * row.size;
      return { path, label, unit: row.unit, size: row.size, style: row.style, low: values, high: values };
    };
    return { path, label, unit: row.unit, make };
  };
  const { parts } = row;
  if (parts.length === 1) return [course(row.path, row.caption, (k) => parts[0].values[k])];
  const own = parts.map((part) => course(`${row.path}.${part.name}`, part.caption, (k) => part.values[k]));
  if (!row.sized) return own;
  return [course(row.path, row.caption, (k) => lengthOf(parts.map((part) => part.values[k]))), ...own];
}

/** @param {object} section @param {object} load @param {number} count */
function ofLoad(section, load, count) {
  const label = section.s ? `${load.caption}, least and greatest` : load.caption;
  const make = () => {
    const low = new Float64Array(count);
    const high = new Float64Array(count);
    for (let k = 0; k < count; k += 1) {
      const values = [...along(section, load, k)].filter((value) => !Number.isNaN(value));
      low[k] = values.length ? Math.min(...values) * load.size : NaN;
      high[k] = values.length ? Math.max(...values) * load.size : NaN;
    }
    const { path, unit, size, style } = load;
    return { path, label, unit, size, style, low, high: section.s ? high : low };
  };
  return { path: load.path, label, unit: load.unit, make };
}

/** All curves there are; each is made when it is asked for. @param {object} data */
export function coursesOf(data) {
  data.courses ??= collected(data);
  return data.courses;
}

/** A curve, made when it is first needed. @returns {Course} */
export function madeOf(course) {
  course.made ??= course.make();
  return course.made;
}

function collected(data) {
  const rows = data.blocks.flatMap((block) => block.groups.flatMap((group) => group.rows));
  return [
    ...rows.flatMap((row) => ofRow(row, data.count)),
    ...data.sections.flatMap((section) => section.loads.map((load) => ofLoad(section, load, data.count))),
  ];
}

/** Over what curves can be drawn: time, and the angles of cranks. @returns {{label: string, values: Float64Array}[]} */
export function axesOf(data) {
  data.axes ??= foundAxes(data);
  return data.axes;
}

function foundAxes(data) {
  const cranks = [...data.rows.values()].filter((row) => /^coordinates\..*\.angle$/.test(row.path)).filter((row) => {
    const { values } = row.parts[0];
    const way = Math.sign(values[values.length - 1] - values[0]);
    const turns = Math.abs(values[values.length - 1] - values[0]) >= ROUND;
    return turns && values.every((value, k) => k === 0 || (value - values[k - 1]) * way >= 0);
  });
  return [
    { label: "time", unit: "s", values: data.time },
    ...cranks.map(({ caption, parts }) => {
      const values = parts[0].values.map((v) => v * DEGREES);
      return { label: caption.replace(/, angle$/, " angle"), unit: "°", values };
    }),
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
