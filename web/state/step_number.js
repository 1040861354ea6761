/** Steps numbers as people type them (`12.5 mm`, `1.2k`, `-0.05`), exact in decimal: `0.3` is never `0.30000000000000004`. */

/**
 * @typedef {{text: string, caret: number, place: number}} Stepped  `place`: the power of ten of the stepped digit in the typed
 *   unit, 2 for hundreds.
 */

/** Sign, digits with spaces between groups, separator, decimals, and the rest: exponent and unit. */
const TYPED = /^\s*([-+−]?)((?:\d(?:[\s\u202f\u00a0](?=\d{3}(?!\d)))?)*)([.,]?)(\d*)(.*)$/s;
/** Longer numbers are not stepped. */
const MAX_DIGITS = 40;

/** The parts of a typed number; null if there is none. @param {string} text */
function partsOf(text) {
  const [, sign, grouped, mark, decimals, rest] = TYPED.exec(text) ?? [];
  const whole = grouped?.replace(/\D/g, "");
  const { length } = `${whole}${decimals}`;
  if (grouped === undefined || length === 0 || length > MAX_DIGITS || rest.includes(",")) return null;
  const start = text.indexOf(grouped + mark + decimals);
  return { sign, grouped, whole, mark, decimals, rest, start, point: start + grouped.length };
}

/** The place of the digit before the caret, or of the first or last digit. @param {string} text @param {number} caret */
export function placeAt(text, caret) {
  const parts = partsOf(text);
  if (!parts) return null;
  const { start, point, mark, decimals, whole } = parts;
  const inDecimals = Math.min(caret, point + mark.length + decimals.length) - point - mark.length;
  if (decimals && (inDecimals > 0 || !whole)) return -Math.max(1, inDecimals);
  return text.slice(Math.min(point, Math.max(caret, start + 1)), point).replace(/\D/g, "").length;
}

/** A place for scrubbing, so that a step is one to ten percent of the value. @param {string} text @param {boolean} integer */
export function scrubPlace(text, integer) {
  const parts = partsOf(text);
  if (!parts) return null;
  const { whole, decimals } = parts;
  const first = `${whole}${decimals}`.search(/[1-9]/);
  const place = first < 0 ? -Math.max(1, decimals.length) : whole.length - first - 2;
  return integer ? Math.max(0, place) : place;
}

/**
 * A typed number plus `by` × 10^`place`, with the same separator and unit; null without a number.
 * @param {string} text @param {number} place @param {number} by @param {boolean} [rounds]  Whether the number is first rounded away
 *   from the result: the value 0.000001 at its limit becomes 0.1, not 0.100001.
 */
export function added(text, place, by, rounds = false) {
  const parts = partsOf(text);
  if (!parts) return null;
  const { sign, whole, mark, decimals, rest } = parts;
  let length = Math.max(decimals.length, -place);
  let before = BigInt(`${whole}${decimals.padEnd(length, "0")}`) * (/[-−]/.test(sign) ? -1n : 1n);
  if (rounds) {
    const unit = 10n ** BigInt(place + length);
    const above = ((before % unit) + unit) % unit;
    before += by > 0 || above === 0n ? -above : unit - above;
    const short = Math.max(0, -place);
    before /= 10n ** BigInt(length - short);
    length = short;
  }
  const next = before + BigInt(by) * 10n ** BigInt(place + length);
  const digits = String(next < 0n ? -next : next).padStart(length + 1, "0");
  const point = digits.length - length;
  return `${next < 0n ? "-" : ""}${digits.slice(0, point)}${length ? mark || "." : ""}${digits.slice(point)}${rest}`;
}

/**
 * Steps the digit before the caret, which stays after it. @param {string} text @param {number} caret @param {number} by
 * @param {number} [place]  The place of the previous step, because `100` − 100 has no hundreds left. @param {boolean} [rounds]  See `added`.
 * @returns {Stepped | null}
 */
export function stepped(text, caret, by, place = placeAt(text, caret) ?? 0, rounds = false) {
  const next = added(text, place, by, rounds);
  return next === null ? null : { text: next, caret: caretAt(next, place), place };
}

/** The caret after a digit. @param {string} text @param {number} place */
export function caretAt(text, place) {
  const parts = partsOf(text);
  if (!parts) return text.length;
  const { start, point, mark } = parts;
  return place < 0 ? point + mark.length - place : Math.max(start + 1, point - place);
}
