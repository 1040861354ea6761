/** Reads numbers as people type them: SI prefixes (`1.2k`, `50 us`), units (`9600 bps`, `10 mm/s`), a decimal comma. */

/** @typedef {{integer?: boolean, clockHz?: number, min?: number, max?: number}} Options  The range is only for suggestions. */
/** @typedef {{value: number} | {message: string}} Parsed */

/** @type {{[prefix: string]: number}} */
const POWERS = { G: 9, M: 6, k: 3, "": 0, c: -2, m: -3, u: -6, n: -9, p: -12 };
const COMMON = ["G", "M", "k", "", "m", "u", "n", "p"];
const OF_LENGTHS = ["k", "", "c", "m", "u", "n"];
const OF_COUNTS = ["M", "k", ""];
const COUNTED = /^(steps|ticks|cycles|pulses|digits|gridsteps|baud|ppm|deg|rpm)/;

/** Units with a prefix of their own: "3 m" is 3000 mm. */
const PREFIXED = /^(m(m|s|A|H|Nm)|n(s)|u(s|F|Nms))(\/.*)?$/;

/** Other spellings. @type {{[unit: string]: string[]}} */
const SPELLINGS = {
  baud: ["bps", "bit/s", "bits/s", "Bd"],
  Hz: ["pps", "1/s"],
  s: ["sec", "second", "seconds"],
  deg: ["degree", "degrees"],
  "deg/s": ["degree/s", "degrees/s"],
  rpm: ["1/min", "r/min", "rev/min"],
  steps: ["step"],
  "steps/s": ["step/s", "pps", "Hz"],
  cycles: ["cycle"],
  ticks: ["tick"],
  pulses: ["pulse"],
  V: ["volt", "volts"],
};

const NUMBER = /^([-+−]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/;

/** The number and the unit of a text. @param {string} text */
function split(text) {
  const match = NUMBER.exec(text.trim().replace(/(\d)[\s\u202f\u00a0](?=\d)/g, "$1"));
  return match && { digits: match[1], suffix: match[2].trim() };
}

/**
 * A number in `unit`. A field of cycles also takes a time, which `clockHz` converts to cycles.
 * @param {string} text
 * @param {string} unit  Such as "s", "Hz", "cycles"; "" for a plain number.
 * @param {Options} [options]
 * @returns {Parsed}
 */
export function parseNumber(text, unit, options = {}) {
  const example = exampleOf(unit, options);
  if (text.trim() === "") return { message: `A number is missing; use one, such as ${example}.` };
  const parts = split(text);
  if (!parts) return { message: `“${text.trim()}” is not a number; use one, such as ${example}.` };
  const { digits, suffix } = parts;
  // A comma with three digits separates thousands for some people and decimals for others.
  if (/^[-+−]?[1-9]\d{0,2}(,\d{3})+$/.test(digits)) {
    return {
      message: `“${digits}” can mean ${digits.replaceAll(",", "")} or ${digits.replace(",", ".")}; use a number without a comma.`,
    };
  }
  const mantissa = digits.replace("−", "-").replace(",", ".");
  const value = converted(mantissa, suffix, unit);
  if (value !== null) return checked(value, options, text);
  if (unit === "cycles" && options.clockHz) {
    const seconds = converted(mantissa, suffix, "s");
    if (seconds !== null) return { value: Math.round(seconds * options.clockHz) };
  }
  const allowed = unit === "cycles" ? "cycles or a time, such as 2.5 us" : unit || "a number without a unit";
  return { message: `“${suffix}” is not a unit of this field; use ${allowed}.` };
}

/**
 * A number with one of several units; a typed unit replaces the current one.
 * @param {string} text @param {{[name: string]: string}} units  Names and labels. @param {string} current  Name of the current unit.
 * @returns {{unit: string, value: number} | {message: string}}
 */
export function parseQuantity(text, units, current) {
  const suffix = split(text)?.suffix ?? "";
  const names = [current, ...Object.keys(units)];
  const unit = names.find((name) => converted("1", suffix, units[name] ?? "") !== null);
  if (unit === undefined) {
    const labels = Object.values(units);
    const last = labels.pop();
    return {
      message: `“${suffix}” is not a unit of this field; use ${labels.join(", ")}${labels.length ? " or " : ""}${last}.`,
    };
  }
  const parsed = parseNumber(text, units[unit] ?? "");
  return "message" in parsed ? parsed : { unit, value: parsed.value };
}

/** @param {string} unit @param {Options} options */
function exampleOf(unit, { integer }) {
  if (unit === "ns") return "1900 or 1.9 us";
  if (unit === "µs") return "25 or 0.1 ms";
  if (integer) return "1200 or 1.2k";
  return unit === "s" ? "0.4 or 400 ms" : "2.5 or 1.2k";
}

/** A unit in ASCII: `mN·m` is `mNm`, `°/s` is `deg/s`. @param {string} unit */
function ascii(unit) {
  return unit
    .replace(/[µμ]/g, "u")
    .replace(/[ΩΩ]/g, "ohm")
    .replace(/°/g, "deg")
    .replace(/²|\^2/g, "2")
    .replace(/³|\^3/g, "3")
    .replace(/[·*\s]/g, "");
}

/** The value in a unit; null if the suffix does not fit. @param {string} mantissa @param {string} suffix @param {string} unit */
function converted(mantissa, suffix, unit) {
  const [given, wanted] = [ascii(suffix), ascii(unit)];
  if (given === "") return Number(mantissa);
  const own = PREFIXED.test(wanted) ? POWERS[wanted[0]] : 0;
  const base = own === 0 ? wanted : wanted.slice(1);
  const prefixes = COUNTED.test(base) ? OF_COUNTS : /^m(\/|$)/.test(base) && own !== 0 ? OF_LENGTHS : COMMON;
  // A prefix alone is enough for units without one.
  for (const name of [base, ...(SPELLINGS[base] ?? []), ...(own === 0 ? [""] : [])]) {
    const isAtEnd = name.length > 2 ? given.toLowerCase().endsWith(name.toLowerCase()) : given.endsWith(name);
    const prefix = isAtEnd ? given.slice(0, given.length - name.length) : null;
    // Shifted as text, so that 50 us is exactly 0.00005.
    if (prefix !== null && prefixes.includes(prefix)) return Number(shifted(mantissa, POWERS[prefix] - own));
  }
  return null;
}

/** @param {string} mantissa @param {number} power */
function shifted(mantissa, power) {
  const [digits, exponent = "0"] = mantissa.split(/[eE]/);
  return `${digits}e${Number(exponent) + power}`;
}

/** @param {number} value @param {Options} options @param {string} text @returns {Parsed} */
function checked(value, { integer, min = -Infinity, max = Infinity }, text) {
  if (!Number.isFinite(value)) return { message: `“${text.trim()}” is too large for a number.` };
  if (integer && !Number.isInteger(value)) {
    const next = [Math.floor, Math.ceil].map((round) => Math.min(max, Math.max(min, round(value))));
    return { message: `${value} is not a whole number; use ${[...new Set(next)].join(" or ")}.` };
  }
  return { value };
}
