/** @file Numbers as text, to the digits that a reader compares and the run can stand behind. */

const DIGITS = 6;

/**
 * @typedef {[number, boolean, number, boolean]} Style
 * decimals; whether with an exponent; what is not above it is 0; whether any digit is known
 */

/**
 * A number in the unit in which it is shown.
 * @param {number} value @param {Style} style @returns {string}
 */
export function formatNumber(value, [decimals, exponent, rounding, known]) {
  if (Number.isNaN(value)) return "open";
  if (!Number.isFinite(value)) return "unbounded";
  const size = Math.abs(value);
  if (size <= rounding) return "0";
  if (!known) return "?";
  if (size < 0.5 * 10 ** -decimals) return "0";
  if (!exponent) return signed(value.toFixed(Math.max(decimals, 0)));
  const lead = Math.floor(Math.log10(size));
  return signed(value.toExponential(Math.min(Math.max(decimals + lead, 0), DIGITS - 1)));
}

/** With the sign of minus that is as wide as plus. @param {string} text @returns {string} */
function signed(text) {
  return text.startsWith("-") ? `−${text.slice(1)}` : text;
}

/** A number with as many digits as the page holds. @param {number} value @returns {string} */
export function formatAllDigits(value) {
  return signed(String(Number(value.toPrecision(DIGITS))));
}

/** A number of an axis or a scale, short. @param {number} value @returns {string} */
export function formatShort(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return signed(size >= 1e6 || size < 1e-4 ? value.toExponential(1) : String(Number(value.toPrecision(4))));
}

/** An instant, to a part of the run. @param {number} t [s] @param {number} span [s] @param {number} places of it */
export function instant(t, span, places = 5) {
  const decimals = span > 0 ? Math.min(20, Math.max(0, places - Math.ceil(Math.log10(span)))) : DIGITS;
  const text = t.toFixed(decimals);
  return signed(text.includes(".") ? text.replace(/0+$/, "").replace(/\.$/, "") : text);
}

/** The largest of 1, 2, 5 times a power of ten that is not above a number > 0. @param {number} most */
export function roundBelow(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].find((step) => step * power <= most * (1 + 1e-9)) * power;
}
