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

/** A column: steps from differences of differences (see packing.py), or floating-point numbers. */
function unpacked(bytes, [offset, count, lag, order, step]) {
  const found = new Float64Array(count);
  if (step === 0) {
    const view = gathered(bytes, offset, count, order);
    const read = order === 8 ? (k) => view.getFloat64(8 * k, true) : (k) => view.getFloat32(4 * k, true);
    for (let k = 0; k < count; k += 1) found[k] = read(k);
    return found;
  }
  const view = gathered(bytes, offset, count, 4);
  for (let k = 0; k < count; k += 1) {
    const folded = view.getUint32(4 * k, true);
    found[k] = folded % 2 ? -(folded + 1) / 2 : folded / 2;
  }
  for (let pass = 0; pass < order; pass += 1) for (let k = lag; k < count; k += 1) found[k] += found[k - lag];
  for (let k = 0; k < count; k += 1) found[k] *= step;
  return found;
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
  const columns = bytes.subarray(4 + length);
  const text = new TextDecoder().decode(bytes.subarray(4, 4 + length));
  const revive = (_, value) => (value && Array.isArray(value.packed) ? unpacked(columns, value.packed) : value);
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

/** A run, ready to be shown. */
function prepared(data) {
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
 * The data of the page.
 * @param {string} text base64 of a deflated block @param {number} run the number of the load case
 * @returns {Promise<{data: object, cases: string[]}>}
 */
export function readData(text, run) {
  return inflated(bytesOf(text)).then((bytes) => {
    const data = parsed(bytes);
    const runs = data.runs ?? [data];
    return { data: prepared(runs[run] ?? runs[0]), cases: runs.map((each) => each.case) };
  });
}
