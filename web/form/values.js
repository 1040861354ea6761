/** What is typed into a field and what it means: texts to values and back, units, and the same value in another light. */
import { si } from "../state/number.js";
import { parseNumber, parseQuantity } from "../state/parse_number.js";
import { get } from "../state/paths.js";
import { derivedAxis } from "../state/queries.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("./field.js").Field} Field */

/** How lists are typed, once that has loaded; no field of one is made before. @type {import("./lists.js").Lists} */
let lists = {};

/** @param {import("./lists.js").Lists} loaded */
export function takeLists(loaded) {
  lists = loaded;
}

/** What stands next to the field of a list. @param {Field} field */
export const listTools = ({ kind }) => lists[kind]?.tools;

/** Whether a field holds a list whose way of typing loads with the first of them. @param {Field} field */
export function isList({ kind }) {
  return kind === "wholes" || kind === "segments" || kind === "points";
}

/** @param {any} a @param {any} b */
export function isSame(a, b) {
  return a === b || (typeof a === "object" && JSON.stringify(a) === JSON.stringify(b));
}

/** A value as it is typed. @param {any} value @param {Field} field */
export function print(value, field) {
  if (value === null || value === undefined) return "";
  if (field.kind === "quantity") return String(Object.values(value)[0]);
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

/** The digits alone, however bytes are written: `81 0A`, `0x81 0x0a`. @param {string} text */
function bare(text) {
  return text.replace(/\b0x/gi, "").replace(/\s+/g, "").toLowerCase();
}

/** The value of a text. @param {string} text @param {Field} field @param {State} state @param {any} before  The value before. @returns {{value: any} | {message: string}} */
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
      return { value: bare(text) };
    case "optional-hex":
      return { value: bare(text) || null };
    case "lines":
      return {
        value: text
          .split("\n")
          .map(bare)
          .filter((line) => line !== ""),
      };
    case "optional-number":
      if (text.trim() === "") return { value: null };
      return parseNumber(text, unit);
    case "optional":
    case "optional-cycles":
      if (text.trim() === "") return { value: null };
      return parseNumber(text, unit, { integer: true, clockHz });
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

/** A quantity in another unit, the same way where the mechanics are known. @param {any} value @param {string} to @param {string} path @param {State} state */
export function convert(value, to, path, state) {
  const from = Object.keys(value)[0];
  const amount = Number(value[from]);
  const [a, b] = [stepsIn(from, path, state), stepsIn(to, path, state)];
  if (a === null || b === null || !Number.isFinite(amount)) return { [to]: value[from] };
  return { [to]: Number(((amount * a) / b).toPrecision(10)) };
}

/** Steps in one of a unit. @param {string} unit @param {string} path @param {State} state @returns {number | null} */
function stepsIn(unit, path, state) {
  const axis = derivedAxis(state, path);
  if (unit.startsWith("steps")) return 1;
  const step = unit.startsWith("mm") ? axis?.step_mm : axis?.step_deg;
  return step ? (unit === "rpm" ? 6 / step : 1 / step) : null;
}

/** The same number in another light: cycles as a time. @param {any} value @param {Field} field @param {State} state */
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
