/** @file Elements of the page. All words go in as text: nothing that a spec says is ever read as a mark. */

/** The element of an id. @param {string} id @returns {HTMLElement} */
export function findElement(id) {
  return document.getElementById(id);
}

/**
 * A new element.
 * @param {string} tag @param {string} text @param {Record<string, string>} [given] attributes
 */
export function makeElement(tag, text = "", given = {}) {
  const element = document.createElement(tag);
  if (text) element.textContent = text;
  for (const [name, value] of Object.entries(given)) element.setAttribute(name, value);
  return element;
}

/** Options of a select: value, words. @param {HTMLSelectElement} select @param {[string, string][]} options */
export function fill(select, options) {
  select.replaceChildren(...options.map(([value, label]) => makeElement("option", label, { value })));
}
