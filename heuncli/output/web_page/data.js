/** @file Decodes the data of the page once: inflates them and unpacks their columns. Numbers are SI; NaN stands
 * for open. */

/** Decode base64. @param {string} text @returns {Uint8Array} */
function decodeBase64(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; k += 1) bytes[k] = letters.charCodeAt(k);
  return bytes;
}

/** Join numbers whose first bytes are stored first, then all second bytes, and so on (see packing.py). */
function joinPlanes(bytes, offset, count, size) {
  const result = new Uint8Array(count * size);
  for (let plane = 0; plane < size; plane += 1) {
    for (let k = 0; k < count; k += 1) result[k * size + plane] = bytes[offset + plane * count + k];
  }
  return new DataView(result.buffer);
}

/**
 * Make a function remember its result for each object, so that what derives from the data is computed once. The results
 * hang on the objects weakly: those of a load case that is dropped go with it.
 * @template {object} T, R @param {(key: T) => R} compute @returns {(key: T) => R}
 */
export function rememberByObject(compute) {
  const results = new WeakMap();
  return (key) => {
    if (!results.has(key)) results.set(key, compute(key));
    return results.get(key);
  };
}

const MAX_GAIN = 64; // as in packing.py

/**
 * Compute the weights by which the numbers before an instant, the last first, predict the one there: Lagrange's
 * polynomial, or one of lower order where it would magnify rounding. packing.py computes the same bits.
 * @param {ArrayLike<number>} times @param {number} order @returns {number[][]} for each instant
 */
export function computeWeights(times, order) {
  const result = [];
  for (let m = 0; m < times.length; m += 1) result.push(computeWeightsAt(times, m, Math.min(order, m)));
  return result;
}

/** @param {ArrayLike<number>} times @param {number} m @param {number} order */
function computeWeightsAt(times, m, order) {
  for (let size = order; size > 0; size -= 1) {
    const weights = new Array(size).fill(1);
    for (let j = 0; j < size; j += 1) {
      for (let k = 0; k < size; k += 1) {
        if (k !== j) weights[j] *= (times[m] - times[m - 1 - k]) / (times[m - 1 - j] - times[m - 1 - k]);
      }
    }
    let gain = 0;
    for (const weight of weights) gain += Math.abs(weight);
    if (gain <= MAX_GAIN) return weights;
  }
  return [];
}

/** Read whole steps; 0, 1, 2, 3, ... stand for 0, -1, 1, -2, ..., so that small steps have small bytes. */
function readSteps(bytes, offset, count) {
  const view = joinPlanes(bytes, offset, count, 4);
  const result = new Float64Array(count);
  for (let k = 0; k < count; k += 1) {
    const folded = view.getUint32(4 * k, true);
    result[k] = folded % 2 ? -(folded + 1) / 2 : folded / 2;
  }
  return result;
}

/** The packed columns; the JSON tells the place and the form of each. */
class Columns {
  /** @param {Uint8Array} bytes */
  constructor(bytes) {
    this.bytes = bytes;
    /** @type {Map<string, number[][]>} */
    this.weights = new Map();
  }

  /** Read floating-point numbers of 4 or 8 bytes. */
  readFloats(offset, count, size) {
    const view = joinPlanes(this.bytes, offset, count, size);
    return Float64Array.from({ length: count }, (_, k) =>
      size === 8 ? view.getFloat64(8 * k, true) : view.getFloat32(4 * k, true),
    );
  }

  /** Get the weights of an order for the instants stored at an offset; offset < 0: for equidistant numbers. */
  getWeights(instants, count, order) {
    const key = `${instants} ${count} ${order}`;
    if (!this.weights.has(key)) {
      const times = instants < 0 ? Array.from({ length: count }, (_, k) => k) : this.readFloats(instants, count, 8);
      this.weights.set(key, computeWeights(times, order));
    }
    return this.weights.get(key);
  }

  /** Read a column: whole steps, each predicted from those before (see packing.py), or floating-point numbers. */
  read([offset, count, lag, order, step, across, instants]) {
    if (step === 0) return this.readFloats(offset, count, order);
    const result = readSteps(this.bytes, offset, count);
    for (let pass = 0; pass < across; pass += 1) {
      for (let k = 0; k < count; k += 1) if (k % lag) result[k] += result[k - 1];
    }
    const weights = this.getWeights(instants, count / lag, order);
    for (let k = lag; k < count; k += 1) {
      let predicted = 0;
      weights[Math.floor(k / lag)].forEach((weight, j) => (predicted += weight * result[k - (j + 1) * lag]));
      result[k] += Math.floor(predicted + 0.5);
    }
    for (let k = 0; k < count; k += 1) result[k] *= step;
    return result;
  }
}

/**
 * Expand a constant column, which is stored as one number.
 * @param {Float64Array|number} packed @param {number} count how many there are
 * @returns {Float64Array}
 */
function expandColumn(packed, count) {
  return typeof packed === "number" ? new Float64Array(count).fill(packed) : packed;
}

/** Parse a block of bytes: the JSON, with each packed column in its place. */
function parseBlock(bytes) {
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const columns = new Columns(bytes.subarray(4 + length));
  const text = new TextDecoder().decode(bytes.subarray(4, 4 + length));
  const revive = (_, value) => (value && Array.isArray(value.packed) ? columns.read(value.packed) : value);
  return JSON.parse(text, revive);
}

/** Inflate. @param {Uint8Array} bytes @returns {Promise<Uint8Array>} */
function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer().then((buffer) => new Uint8Array(buffer));
}

/** Collect the rows of all tables by their paths; those of impulses have one frame. */
function collectRows(data, count) {
  const rows = new Map();
  const blocks = [
    ...data.blocks.map((block) => [block, count]),
    ...data.impulses.flatMap((impulse) => impulse.blocks.map((block) => [block, 1])),
  ];
  for (const [block, own] of blocks) {
    for (const row of block.groups.flatMap((group) => group.rows)) {
      row.parts = row.parts.map(([name, packed, caption]) => ({ name, caption, values: expandColumn(packed, own) }));
      row.fixed = own !== count;
      rows.set(row.path, row);
    }
  }
  return rows;
}

/** Prepare a load case in place, once, so that it can be shown. @param {CaseData} data */
export function prepareCase(data) {
  if (data.rows) return data;
  const { count, scene } = data;
  data.time = expandColumn(data.time, count);
  for (const surface of scene.bodies.flatMap((body) => body.surfaces)) {
    if (!surface.ball) surface.faces = scene.topologies[surface.faces];
  }
  data.rows = collectRows(data, count);
  for (const load of data.acting) load.forces = expandColumn(load.forces, 3 * count);
  for (const section of data.sections) {
    for (const load of section.loads) load.values = expandColumn(load.values, count * section.cuts.length);
  }
  return data;
}

/**
 * Read the load cases of the page; `prepareCase` makes each one ready.
 * @param {string} text base64 of a deflated block @returns {Promise<CaseData[]>}
 */
export function readData(text) {
  return inflate(decodeBase64(text)).then((bytes) => {
    const data = parseBlock(bytes);
    return data.runs ?? [data];
  });
}
