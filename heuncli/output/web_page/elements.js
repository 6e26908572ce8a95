/** @file Finds and makes elements. Words go in as text, never as markup, since they may come from a spec. */

/** Find an element that the page has. @param {string} id @returns {HTMLElement} */
export function findElement(id) {
  return document.getElementById(id);
}

/**
 * Make an element.
 * @param {string} tag @param {string} text @param {Record<string, string>} [given] attributes
 */
export function makeElement(tag, text = "", given = {}) {
  const element = document.createElement(tag);
  if (text) element.textContent = text;
  for (const [name, value] of Object.entries(given)) element.setAttribute(name, value);
  return element;
}

/**
 * Fill a select with options of value and words.
 * @param {HTMLSelectElement} select @param {[string, string][]} options
 */
export function fillSelect(select, options) {
  select.replaceChildren(...options.map(([value, label]) => makeElement("option", label, { value })));
}
