/** Reads and prints the values of fields, converts their units, and describes them. */
import { si } from "../state/number.js";
import { parseNumber, parseQuantity } from "../state/parse_number.js";
import { get } from "../state/paths.js";
import { derivedAxis } from "../state/queries.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("./field.js").Field} Field */

/** Formats of lists, loaded before the first field with a list. @type {import("./lists.js").Lists} */
let lists = {};

/** @param {import("./lists.js").Lists} loaded */
export function setLists(loaded) {
  lists = loaded;
}

/** The buttons next to the field of a list. @param {Field} field */
export const listTools = ({ kind }) => lists[kind]?.tools;

/** Whether a field contains a list. @param {Field} field */
export function isList({ kind }) {
  return kind === "wholes" || kind === "segments" || kind === "points";
}

/** @param {any} a @param {any} b */
export function isSame(a, b) {
  return a === b || (typeof a === "object" && JSON.stringify(a) === JSON.stringify(b));
}

/** A value as editable text. @param {any} value @param {Field} field */
export function print(value, field) {
  if (value === null || value === undefined) return "";
  if (field.kind.endsWith("quantity")) return String(Object.values(value)[0]);
  if (field.kind === "lines") return value.map(spaced).join("\n");
  const list = lists[field.kind];
  if (list) return list.print(value);
  return isHex(field) ? spaced(value) : String(value);
}

/** @param {Field} field */
export function isHex({ kind }) {
  return kind === "hex" || kind === "optional-hex";
}

/** @param {any} hex */
function spaced(hex) {
  return String(hex)
    .replace(/\s+/g, "")
    .replace(/(..)(?=.)/g, "$1 ");
}

/** The hex digits of bytes such as `81 0A` or `0x81 0x0a`. @param {string} text */
function hexDigits(text) {
  return text.replace(/\b0x/gi, "").replace(/\s+/g, "").toLowerCase();
}

/** Reads a text. @param {string} text @param {Field} field @param {State} state @param {any} before  The value before. @returns {{value: any} | {message: string}} */
export function read(text, field, state, before) {
  const clockHz = Number(state.scenario.clock_hz) || undefined;
  const unit = field.unit ?? "";
  const list = lists[field.kind];
  if (list) return list.read(text);
  switch (field.kind) {
    case "choice":
      if (text === "") return { value: null };
      if (text === "true" || text === "false") return { value: text === "true" };
      return { value: /^\d+$/.test(text) ? Number(text) : text };
    case "text":
      return { value: text };
    case "hex":
      return { value: hexDigits(text) };
    case "optional-hex":
      return { value: hexDigits(text) || null };
    case "lines":
      return {
        value: text
          .split("\n")
          .map(hexDigits)
          .filter((line) => line !== ""),
      };
    case "optional-number":
      if (text.trim() === "") return { value: null };
      return parseNumber(text, unit);
    case "optional":
    case "optional-cycles":
      if (text.trim() === "") return { value: null };
      return parseNumber(text, unit, { integer: true, clockHz });
    case "optional-quantity":
      if (text.trim() === "") return { value: null };
      return readQuantity(text, field, before);
    case "quantity":
      return readQuantity(text, field, before);
    case "number":
      return parseNumber(text, unit);
    default:
      return parseNumber(text, unit, { integer: true, clockHz });
  }
}

/** `250 mm` also selects the unit. @param {string} text @param {Field} field @param {any} before @returns {{value: any} | {message: string}} */
function readQuantity(text, { units = {} }, before) {
  const parsed = parseQuantity(text, units, Object.keys(before ?? units)[0]);
  return "message" in parsed ? parsed : { value: { [parsed.unit]: parsed.value } };
}

/** Converts a quantity to another unit. Without known mechanics the number stays. @param {any} value @param {string} to @param {string} path @param {State} state */
export function convert(value, to, path, state) {
  const from = Object.keys(value)[0];
  const amount = Number(value[from]);
  const [fromSteps, toSteps] = [stepsIn(from, path, state), stepsIn(to, path, state)];
  if (fromSteps === null || toSteps === null || !Number.isFinite(amount)) return { [to]: value[from] };
  return { [to]: Number(((amount * fromSteps) / toSteps).toPrecision(10)) };
}

/** Steps per unit; null if unknown. @param {string} unit @param {string} path @param {State} state @returns {number | null} */
function stepsIn(unit, path, state) {
  const axis = derivedAxis(state, path);
  if (unit.startsWith("steps")) return 1;
  const step = unit.startsWith("mm") ? axis?.step_mm : axis?.step_deg;
  return step ? (unit === "rpm" ? 6 / step : 1 / step) : null;
}

/** Additional meaning of a value, such as cycles as a time. @param {any} value @param {Field} field @param {State} state */
export function meaning(value, field, state) {
  const also = field.also?.(value, state);
  if (also) return also;
  const clock = get(state.scenario, "clock_hz");
  if (field.kind.endsWith("cycles") && Number.isFinite(value) && value !== null && clock > 0)
    return `= ${si(value / clock, "s")}`;
  if (field.key === "clock_hz" && value > 0) return `one cycle = ${si(1 / value, "s")}`;
  if (field.key === "microsteps" || typeof value !== "number") return "";
  if (field.key === "timer_hz" || field.key === "baud") return value >= 10000 ? `= ${si(value, field.unit ?? "")}` : "";
  return "";
}
