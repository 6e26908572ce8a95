/** @file The data of the page: read once, arrays unpacked. Numbers are SI; nan stands for what is open. */

/** @param {string} text base64 @returns {ArrayBuffer} */
function bytesOf(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; k += 1) bytes[k] = letters.charCodeAt(k);
  return bytes.buffer;
}

/** Whether this machine keeps the least significant byte first, as the data do. */
const LITTLE = new Uint8Array(new Uint16Array([1]).buffer)[0] === 1;

/** @param {ArrayBuffer} buffer @param {number} size bytes of a number @returns {ArrayBuffer} */
function inOrder(buffer, size) {
  if (LITTLE) return buffer;
  const bytes = new Uint8Array(buffer);
  for (let k = 0; k < bytes.length; k += size) bytes.subarray(k, k + size).reverse();
  return buffer;
}

/**
 * Numbers with all their digits: packed, or one that all of them are.
 * @param {string|number} packed @param {number} count how many there are
 * @returns {Float64Array}
 */
export function numbers(packed, count) {
  if (typeof packed === "number") return new Float64Array(count).fill(packed);
  return new Float64Array(inOrder(bytesOf(packed), 8));
}

/** Places that are drawn. @param {string} packed @returns {Float32Array} */
export function places(packed) {
  return new Float32Array(inOrder(bytesOf(packed), 4));
}

/** The data of the page, unpacked in place. @param {string} text JSON @returns {object} */
export function readData(text) {
  const data = JSON.parse(text);
  const { count } = data;
  data.time = numbers(data.time, count);
  for (const body of data.scene.bodies) {
    body.places = places(body.places);
    body.attitudes = places(body.attitudes);
    body.bars = body.bars.map(places);
    body.lines = body.lines.map(places);
    for (const surface of body.surfaces) {
      if (surface.ball) continue;
      surface.corners = places(surface.corners);
      surface.faces = data.scene.topologies[surface.faces];
    }
  }
  const { scene } = data;
  scene.paths = scene.paths.map(places);
  for (const belt of scene.belts) [belt.strands, belt.run] = [places(belt.strands), places(belt.run)];
  for (const pull of scene.pulls) {
    pull.at = places(pull.at);
    pull.forces &&= places(pull.forces);
  }
  for (const rope of scene.ropes) rope.ends = places(rope.ends);
  for (const mark of scene.marks) [mark.places, mark.ways] = [places(mark.places), places(mark.ways)];
  data.rows = new Map();
  const blocks = [
    ...data.blocks.map((b) => [b, count]),
    ...data.blows.flatMap((blow) => blow.blocks.map((b) => [b, 1])),
  ];
  for (const [block, own] of blocks) {
    for (const group of block.groups) {
      for (const row of group.rows) {
        row.parts = row.parts.map(([name, packed]) => ({ name, values: numbers(packed, own) }));
        row.fixed = own !== count;
        data.rows.set(row.path, row);
      }
    }
  }
  for (const section of data.sections) {
    for (const load of section.loads) load.values = numbers(load.values, count * section.cuts.length);
  }
  return data;
}
