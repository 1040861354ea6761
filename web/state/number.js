/** Numbers as the page prints them, always with a unit. */

const PREFIXES = /** @type {const} */ ([
  [1e9, "G"],
  [1e6, "M"],
  [1e3, "k"],
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
]);

/**
 * A number with an SI prefix: `12.35 kHz`.
 * @param {number} value
 * @param {string} unit
 * @param {number} [digits]  Significant digits.
 */
export function si(value, unit, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return `0 ${unit}`.trim();
  const magnitude = Math.abs(value);
  const [scale, prefix] = PREFIXES.find(([scale]) => magnitude >= scale * 0.99995) ?? PREFIXES[PREFIXES.length - 1];
  return `${trim((value / scale).toPrecision(digits))} ${prefix}${unit}`.trim();
}

/** A rate or count of steps, with grouped digits and without a prefix. @param {number} value @param {string} unit */
export function plain(value, unit) {
  if (!Number.isFinite(value)) return "–";
  const magnitude = Math.abs(value);
  if (magnitude >= 1e9 && magnitude < 1e12) return `${group(short(value))} ${unit}`;
  if (magnitude >= 1e12 || (magnitude > 0 && magnitude < 0.01)) return `${short(value)} ${unit}`;
  const [whole, part] = trim(value.toFixed(magnitude >= 1000 ? 0 : magnitude >= 10 ? 1 : 3)).split(".");
  return `${group(whole)}${part ? `.${part}` : ""} ${unit}`;
}

/** @param {string} digits */
function group(digits) {
  return digits.replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f");
}

/** A number with significant digits, without trailing zeros. @param {number} value @param {number} [digits] */
export function short(value, digits = 5) {
  if (!Number.isFinite(value)) return "–";
  return trim(value.toPrecision(digits));
}

/** A whole number with groups of three digits. @param {number} value */
export function count(value) {
  return group(Math.round(value).toString()).replace("-", "−");
}

/** @param {string} text */
function trim(text) {
  // From 10¹² on an exponent is easier to read.
  const plain = text.includes("e")
    ? Math.abs(Number(text)) < 1e12
      ? String(Number(text))
      : text.replace(/\.?0*e\+?/, "e")
    : text;
  return (plain.includes(".") && !plain.includes("e") ? plain.replace(/\.?0+$/, "") : plain).replace("-", "−");
}

/** A number and its noun, in the plural if needed. @param {number} number @param {string} noun */
export function counted(number, noun) {
  return `${count(number)} ${noun}${number === 1 ? "" : "s"}`;
}

/** Texts of the core with the page's unit signs. @param {string} text */
export function pretty(text) {
  return text
    .replace(/\bs\^2\b/g, "s²")
    .replace(/\bs\^3\b/g, "s³")
    .replaceAll("mN*m", "mN·m");
}

/** Time with enough digits to tell one cycle from the next. @param {number} seconds */
export function time(seconds) {
  return si(seconds, "s", 7);
}

/** The time of a cycle, with enough digits to tell it from the next cycle. @param {number} cycle @param {number} clockHz */
export function exactTime(cycle, clockHz) {
  return si(cycle / clockHz, "s", Math.max(7, String(Math.abs(cycle)).length + 1));
}
