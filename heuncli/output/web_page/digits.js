/** @file Formats numbers, with the digits of the tables that `heun run` prints. */

const MAX_DIGITS = 6;

/**
 * Format a number given in the unit in which it is shown.
 * @param {number} value @param {Style} style @returns {string}
 */
export function formatNumber(value, [decimals, exponent, rounding, known]) {
  if (Number.isNaN(value)) return "open";
  if (!Number.isFinite(value)) return "unbounded";
  const size = Math.abs(value);
  if (size <= rounding) return "0";
  if (!known) return "?";
  if (size < 0.5 * 10 ** -decimals) return "0";
  if (!exponent) return useMinusSign(value.toFixed(Math.max(decimals, 0)));
  const lead = Math.floor(Math.log10(size));
  return useMinusSign(value.toExponential(Math.min(Math.max(decimals + lead, 0), MAX_DIGITS - 1)));
}

/** Replace the hyphen by the minus sign, which is as wide as plus. @param {string} text @returns {string} */
function useMinusSign(text) {
  return text.startsWith("-") ? `−${text.slice(1)}` : text;
}

/** Format a unit to stand after a number; a plain number has none. @param {string} unit */
export function formatUnit(unit) {
  return unit === "1" ? "" : unit;
}

/** Format a number with its unit. @param {number} value in that unit @param {Style} style @param {string} unit */
export function formatWithUnit(value, style, unit) {
  return `${formatNumber(value, style)} ${formatUnit(unit)}`.trim();
}

/** Format a number with all digits that the page holds. @param {number} value @returns {string} */
export function formatAllDigits(value) {
  return useMinusSign(String(Number(value.toPrecision(MAX_DIGITS))));
}

/** Format a number of an axis or a scale. @param {number} value @returns {string} */
export function formatShort(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return useMinusSign(size >= 1e6 || size < 1e-4 ? value.toExponential(1) : String(Number(value.toPrecision(4))));
}

/** Format an instant with `places` digits of the duration. @param {number} t [s] @param {number} duration [s] */
export function formatInstant(t, duration, places = 5) {
  const decimals = duration > 0 ? Math.min(20, Math.max(0, places - Math.ceil(Math.log10(duration)))) : MAX_DIGITS;
  const text = t.toFixed(decimals);
  return useMinusSign(text.includes(".") ? text.replace(/0+$/, "").replace(/\.$/, "") : text);
}

/** Round down to 1, 2 or 5 times a power of ten. @param {number} limit */
export function roundBelow(limit) {
  const power = 10 ** Math.floor(Math.log10(limit));
  return [5, 2, 1].find((step) => step * power <= limit * (1 + 1e-9)) * power;
}
