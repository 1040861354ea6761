/** Reads numbers as people type them: SI prefixes (`1.2k`, `50 us`), units (`9600 bps`, `10 mm/s`), a decimal comma. */

/** @typedef {{integer?: boolean, clockHz?: number, min?: number, max?: number}} Options  The range is only for suggestions. */
/** @typedef {{value: number} | {message: string}} Parsed */

/** @type {{[prefix: string]: number}} */
const POWERS = { G: 9, M: 6, k: 3, "": 0, c: -2, m: -3, u: -6, n: -9, p: -12 };
const SI_PREFIXES = ["G", "M", "k", "", "m", "u", "n", "p"];
const LENGTH_PREFIXES = ["k", "", "c", "m", "u", "n"];
const COUNT_PREFIXES = ["M", "k", ""];
const COUNT_UNITS = /^(steps|ticks|cycles|pulses|digits|gridsteps|baud|ppm|deg|rpm)/;

/** Units that already contain a prefix: "3 m" is 3000 mm. */
const PREFIXED_UNITS = ["mm", "ms", "mA", "mH", "mNm", "ns", "us", "uF", "uNms"];

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

/** Space within a number, before a group of three digits. */
const GROUP_SPACE = /(\d)[\s\u202f\u00a0](?=\d{3}(?!\d))/g;
/** Several groups of three digits after commas, which can only be thousands. */
const COMMA_GROUPS = /^[-+−]?[1-9]\d{0,2}(?:,\d{3}){2,}(?![\d,])/;
/** One group of three digits after a comma, which separates thousands for some people and decimals for others. */
const ONE_COMMA_GROUP = /^[-+−]?[1-9]\d{0,2},\d{3}$/;
const NUMBER = /^([-+−]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/;

/** The number and the unit of a text. @param {string} text */
function split(text) {
  const joined = text
    .trim()
    .replace(GROUP_SPACE, "$1")
    .replace(COMMA_GROUPS, (groups) => groups.replaceAll(",", ""));
  const match = NUMBER.exec(joined);
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
  if (text.trim() === "") return { message: `Enter a number, such as ${example}.` };
  const parts = split(text);
  if (!parts) return { message: `“${text.trim()}” is not a number; enter one such as ${example}.` };
  const { digits, suffix } = parts;
  if (ONE_COMMA_GROUP.test(digits)) {
    return {
      message: `“${digits}” can mean ${digits.replace(",", "")} or ${digits.replace(",", ".")}; use a number without a comma.`,
    };
  }
  const mantissa = digits.replace("−", "-").replace(",", ".");
  const value = converted(mantissa, suffix, unit);
  if (value !== null) return checked(value, options, text);
  if (unit === "cycles" && options.clockHz) {
    const seconds = converted(mantissa, suffix, "s");
    if (seconds !== null) return checked(Math.round(seconds * options.clockHz), options, text);
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
    .replace(/[\u00b5\u03bc]/g, "u")
    .replace(/[\u03a9\u2126]/g, "ohm")
    .replace(/°/g, "deg")
    .replace(/²|\^2/g, "2")
    .replace(/³|\^3/g, "3")
    .replace(/[·*\s]/g, "");
}

/** The unit without its prefix, and the power of ten of that prefix. @param {string} unit */
function baseOf(unit) {
  const isPrefixed = PREFIXED_UNITS.includes(unit.split("/", 1)[0]);
  return isPrefixed ? { base: unit.slice(1), ownPower: POWERS[unit[0]] } : { base: unit, ownPower: 0 };
}

/** The prefixes that a unit can have. @param {string} base */
function prefixesOf(base) {
  if (COUNT_UNITS.test(base)) return COUNT_PREFIXES;
  return /^m(\/|$)/.test(base) ? LENGTH_PREFIXES : SI_PREFIXES;
}

/** The prefix of a typed unit if it ends with `name`; else null. @param {string} given @param {string} name */
function prefixBefore(given, name) {
  // Short names are case-sensitive, like the prefixes m and M.
  const isAtEnd = name.length > 2 ? given.toLowerCase().endsWith(name.toLowerCase()) : given.endsWith(name);
  return isAtEnd ? given.slice(0, given.length - name.length) : null;
}

/** The value in a unit; null if the suffix does not fit. @param {string} mantissa @param {string} suffix @param {string} unit */
function converted(mantissa, suffix, unit) {
  const given = ascii(suffix);
  if (given === "") return Number(mantissa);
  const { base, ownPower } = baseOf(ascii(unit));
  const prefixes = prefixesOf(base);
  const names = [base, ...(SPELLINGS[base] ?? [])];
  // "5 m" means 5 ms if the field's unit is s.
  if (ownPower === 0) names.push("");
  for (const name of names) {
    const prefix = prefixBefore(given, name);
    // Shifted as text, so that 50 us is exactly 0.00005.
    if (prefix !== null && prefixes.includes(prefix)) return Number(shifted(mantissa, POWERS[prefix] - ownPower));
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
