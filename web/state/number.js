/**
 * Numbers as people write them: SI prefixes (`1.2k`, `50 us`), units, a decimal comma; and numbers as
 * the page prints them, always with a unit.
 */

/** @type {{[prefix: string]: number}} */
const POWERS = { G: 9, M: 6, k: 3, "": 0, m: -3, u: -6, µ: -6, μ: -6, n: -9, p: -12 };

const NUMBER = /^([-+−]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/;

/**
 * Reads a number in `unit`. A field that counts cycles also takes a time, which `clockHz` turns into cycles.
 * @param {string} text
 * @param {string} unit  Unit that the number is wanted in, such as "s", "Hz", "cycles"; "" for a plain number.
 * @param {{integer?: boolean, clockHz?: number, least?: number, most?: number}} [options]  The range is for what is proposed only.
 * @returns {{value: number} | {message: string}}
 */
export function parseNumber(text, unit, options = {}) {
  const plain = text.trim().replace(/(\d)[\s\u202f\u00a0](?=\d)/g, "$1");
  const example =
    unit === "ns"
      ? "1900 or 1.9 us"
      : unit === "µs"
        ? "25 or 0.1 ms"
        : options.integer
          ? "1200 or 1.2k"
          : unit === "s"
            ? "0.4 or 400 ms"
            : "2.5 or 1.2k";
  if (plain === "") return { message: `A number is missing; give one, such as ${example}.` };
  const match = NUMBER.exec(plain);
  if (!match) return { message: `“${text.trim()}” is not a number; give one, such as ${example}.` };
  // Groups of three after a comma are thousands to some readers and parts to others.
  if (/^[-+−]?[1-9]\d{0,2}(,\d{3})+$/.test(match[1])) {
    return {
      message: `“${match[1]}” can be read as ${match[1].replaceAll(",", "")} or as ${match[1].replace(",", ".")}; write it without a comma.`,
    };
  }
  const mantissa = match[1].replace("−", "-").replace(",", ".");
  const suffix = match[2].trim();
  const shifted = shift(mantissa, suffix, unit);
  if (shifted !== null) return whole(shifted, options, text);
  if (unit === "cycles" && options.clockHz) {
    const seconds = shift(mantissa, suffix, "s");
    if (seconds !== null) return { value: Math.round(seconds * options.clockHz) };
  }
  const allowed = unit === "cycles" ? "cycles or a time, such as 2.5 us" : unit || "a plain number";
  return { message: `“${suffix}” is not a unit of this field; give ${allowed}.` };
}

/**
 * @param {string} mantissa
 * @param {string} suffix
 * @param {string} unit
 * @returns {number | null}  null where the suffix is neither the unit nor a prefix.
 */
function shift(mantissa, suffix, unit) {
  // A millimetre is a metre with a prefix: "3 m" is 3000 mm, never 3 thousandths of one; so is a nanosecond a second.
  const [base, own] = unit.startsWith("mm")
    ? [unit.slice(1), 3]
    : unit === "ns"
      ? ["s", 9]
      : unit === "µs"
        ? ["s", 6]
        : [unit, 0];
  if (suffix === "") return Number(mantissa);
  for (const tail of new Set([base, own ? base : ""])) {
    if (!suffix.endsWith(tail)) continue;
    const prefix = suffix.slice(0, suffix.length - tail.length).trim();
    // Shifted as text, so that 50 us is the very same number as 0.00005.
    if (Object.hasOwn(POWERS, prefix)) return Number(addExponent(mantissa, POWERS[prefix] + own));
  }
  return null;
}

/** @param {string} mantissa @param {number} power */
function addExponent(mantissa, power) {
  const [digits, exponent = "0"] = mantissa.split(/[eE]/);
  return `${digits}e${Number(exponent) + power}`;
}

/**
 * @param {number} value
 * @param {{integer?: boolean, least?: number, most?: number}} options
 * @param {string} text
 * @returns {{value: number} | {message: string}}
 */
function whole(value, { integer, least = -Infinity, most = Infinity }, text) {
  if (!Number.isFinite(value)) return { message: `“${text.trim()}” is too large for a number.` };
  if (integer && !Number.isInteger(value)) {
    const beside = [Math.floor, Math.ceil].map((round) => Math.min(most, Math.max(least, round(value))));
    return { message: `${value} is not a whole number; give ${[...new Set(beside)].join(" or ")}.` };
  }
  return { value };
}

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

/** A rate or count of steps: grouped digits and no prefix, for nobody counts kilosteps. @param {number} value @param {string} unit */
export function plain(value, unit) {
  if (!Number.isFinite(value)) return "–";
  const magnitude = Math.abs(value);
  if (magnitude >= 1e9 || (magnitude > 0 && magnitude < 0.01)) return `${short(value)} ${unit}`;
  const [whole, part] = trim(value.toFixed(magnitude >= 1000 ? 0 : magnitude >= 10 ? 1 : 3)).split(".");
  return `${group(whole)}${part ? `.${part}` : ""} ${unit}`;
}

/** @param {string} digits */
function group(digits) {
  return digits.replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f");
}

/** Significant digits without needless zeros. @param {number} value @param {number} [digits] */
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
  // From 10¹² on nobody counts the noughts.
  const plain = text.includes("e")
    ? Math.abs(Number(text)) < 1e12
      ? String(Number(text))
      : text.replace(/\.?0*e\+?/, "e")
    : text;
  return (plain.includes(".") && !plain.includes("e") ? plain.replace(/\.?0+$/, "") : plain).replace("-", "−");
}

/** A number of things, in words that go with it. @param {number} number @param {string} thing */
export function counted(number, thing) {
  return `${count(number)} ${thing}${number === 1 ? "" : "s"}`;
}

/** The core's words as they are printed elsewhere on the page: units with their signs. @param {string} text */
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

/** The time of a cycle, with all the digits that tell it from the next cycle, however late it is. @param {number} cycle @param {number} clockHz */
export function exactTime(cycle, clockHz) {
  return si(cycle / clockHz, "s", Math.max(7, String(Math.abs(cycle)).length + 1));
}
