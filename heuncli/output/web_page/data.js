/** @file The data of the page: inflated and read once, columns unpacked. Numbers are SI; nan is what is open. */

/** @param {string} text base64 @returns {Uint8Array} */
function bytesOf(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; k += 1) bytes[k] = letters.charCodeAt(k);
  return bytes;
}

/** Bytes that stand in planes, in the order of their numbers. */
function gathered(bytes, offset, count, size) {
  const found = new Uint8Array(count * size);
  for (let plane = 0; plane < size; plane += 1) {
    for (let k = 0; k < count; k += 1) found[k * size + plane] = bytes[offset + plane * count + k];
  }
  return new DataView(found.buffer);
}

const MAX_GAIN = 64; // as in packing.py

/**
 * The weights by which the numbers before an instant, the last first, predict the one there: those of Lagrange's
 * polynomial, or of the next lower order where it would magnify their rounding. To the bit those of packing.py.
 * @param {ArrayLike<number>} times @param {number} order @returns {number[][]} for each instant
 */
export function weightsOf(times, order) {
  const found = [];
  for (let m = 0; m < times.length; m += 1) found.push(weightsAt(times, m, Math.min(order, m)));
  return found;
}

/** @param {ArrayLike<number>} times @param {number} m @param {number} order */
function weightsAt(times, m, order) {
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

/** Whole steps that stand in planes of bytes: 0, 1, 2, 3, ... for 0, -1, 1, -2, ... */
function unfolded(bytes, offset, count) {
  const view = gathered(bytes, offset, count, 4);
  const found = new Float64Array(count);
  for (let k = 0; k < count; k += 1) {
    const folded = view.getUint32(4 * k, true);
    found[k] = folded % 2 ? -(folded + 1) / 2 : folded / 2;
  }
  return found;
}

/** The columns of a block of bytes, by what the JSON says of them. */
class Columns {
  /** @param {Uint8Array} bytes */
  constructor(bytes) {
    this.bytes = bytes;
    /** @type {Map<string, number[][]>} */
    this.weights = new Map();
  }

  /** Floating-point numbers. */
  floats(offset, count, size) {
    const view = gathered(this.bytes, offset, count, size);
    return Float64Array.from({ length: count }, (_, k) =>
      size === 8 ? view.getFloat64(8 * k, true) : view.getFloat32(4 * k, true),
    );
  }

  /** The weights of an order, of the instants at an offset, or of so many numbers at equal distances. */
  weightsFor(instants, count, order) {
    const key = `${instants} ${count} ${order}`;
    if (!this.weights.has(key)) {
      const times = instants < 0 ? Array.from({ length: count }, (_, k) => k) : this.floats(instants, count, 8);
      this.weights.set(key, weightsOf(times, order));
    }
    return this.weights.get(key);
  }

  /** A column: whole steps, predicted from those before (see packing.py), or floating-point numbers. */
  read([offset, count, lag, order, step, across, instants]) {
    if (step === 0) return this.floats(offset, count, order);
    const found = unfolded(this.bytes, offset, count);
    for (let pass = 0; pass < across; pass += 1) {
      for (let k = 0; k < count; k += 1) if (k % lag) found[k] += found[k - 1];
    }
    const weights = this.weightsFor(instants, count / lag, order);
    for (let k = lag; k < count; k += 1) {
      let predicted = 0;
      weights[Math.floor(k / lag)].forEach((weight, j) => (predicted += weight * found[k - (j + 1) * lag]));
      found[k] += Math.floor(predicted + 0.5);
    }
    for (let k = 0; k < count; k += 1) found[k] *= step;
    return found;
  }
}

/**
 * Numbers of a column, or one that all of them are.
 * @param {Float64Array|number} packed @param {number} count how many there are
 * @returns {Float64Array}
 */
function numbers(packed, count) {
  return typeof packed === "number" ? new Float64Array(count).fill(packed) : packed;
}

/** The data in a block of bytes: the JSON, with its columns unpacked where they stand. */
function parsed(bytes) {
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const columns = new Columns(bytes.subarray(4 + length));
  const text = new TextDecoder().decode(bytes.subarray(4, 4 + length));
  const revive = (_, value) => (value && Array.isArray(value.packed) ? columns.read(value.packed) : value);
  return JSON.parse(text, revive);
}

/** What is inflated. @param {Uint8Array} bytes @returns {Promise<Uint8Array>} */
function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer().then((buffer) => new Uint8Array(buffer));
}

/** The rows of all tables by their paths. */
function rowsOf(data, count) {
  const rows = new Map();
  const blocks = [
    ...data.blocks.map((block) => [block, count]),
    ...data.blows.flatMap((blow) => blow.blocks.map((block) => [block, 1])),
  ];
  for (const [block, own] of blocks) {
    for (const row of block.groups.flatMap((group) => group.rows)) {
      row.parts = row.parts.map(([name, packed, caption]) => ({ name, caption, values: numbers(packed, own) }));
      row.fixed = own !== count;
      rows.set(row.path, row);
    }
  }
  return rows;
}

/** A load case, ready to be shown; made so once. @param {object} data */
export function prepared(data) {
  if (data.rows) return data;
  const { count, scene } = data;
  data.time = numbers(data.time, count);
  for (const surface of scene.bodies.flatMap((body) => body.surfaces)) {
    if (!surface.ball) surface.faces = scene.topologies[surface.faces];
  }
  data.rows = rowsOf(data, count);
  for (const load of data.acting) load.forces = numbers(load.forces, 3 * count);
  for (const section of data.sections) {
    for (const load of section.loads) load.values = numbers(load.values, count * section.cuts.length);
  }
  return data;
}

/**
 * The load cases of the page; `prepared` makes each one ready.
 * @param {string} text base64 of a deflated block @returns {Promise<object[]>}
 */
export function readData(text) {
  return inflated(bytesOf(text)).then((bytes) => {
    const data = parsed(bytes);
    return data.runs ?? [data];
  });
}
