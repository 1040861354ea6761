/**
 * One field of the form: a label, an input (or select), its unit, a hint, its error. What is typed goes out
 * as a value, or as a draft while it is no number yet.
 */
import { element, flash, say } from "../dom.js";
import { parseNumber, si } from "../state/number.js";
import { get } from "../state/paths.js";
import { derivedAxis } from "../state/queries.js";
import { termButton } from "./term_button.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("./field.js").Field} Field */

/**
 * @typedef {object} Control
 * @property {HTMLElement} root
 * @property {string} label
 * @property {(value: any, state: State) => void} show
 * @property {(message: string) => void} fail  Shows an error, or none.
 * @property {() => void} focus
 */

/** How lists are typed, once that has loaded; no field of one is made before. @type {import("./lists.js").Lists} */
let lists = {};

/** @param {import("./lists.js").Lists} loaded */
export function takeLists(loaded) {
  lists = loaded;
}

/** More characters than an input beside its label shows. */
const LONG = 12;
let made = 0;

/**
 * @param {string} path
 * @param {Field} field
 * @param {{dispatch: (message: import("../state/message.js").Message) => void, now: () => State}} page
 * @returns {Control}
 */
export function control(path, field, { dispatch, now }) {
  const id = `f${made++}`;
  const error = element("p", { class: "error", id: `${id}-error` });
  const hint = element("p", { class: "hint", id: `${id}-hint` }, field.hint);
  const also = element("span", { class: "also" });
  const labels = { "aria-labelledby": field.unit ? `${id}-label ${id}-unit` : `${id}-label` };
  const described = {
    id,
    ...labels,
    "aria-describedby": `${id}-error ${id}-hint`,
    "aria-keyshortcuts": "F1",
    "data-path": path,
  };
  const long = field.kind === "lines" || isList(field) || field.rows !== undefined;
  const wide = long || field.kind === "text" || isHex(field);
  const input =
    field.kind === "choice"
      ? element(
          "select",
          described,
          ...Object.entries(field.choices ?? {}).map(([value, text]) => element("option", { value }, text)),
        )
      : long
        ? element("textarea", { ...described, rows: String(field.rows ?? 4), spellcheck: "false" })
        : element("input", { ...described, type: "text", spellcheck: "false" });
  const unitSelect = field.units
    ? element(
        "select",
        { "aria-label": `Unit of ${field.label}`, "data-path": `${path}#unit` },
        ...Object.entries(field.units).map(([value, text]) => element("option", { value }, text)),
      )
    : null;
  const unit = field.unit ? element("span", { class: "unit", id: `${id}-unit` }, field.unit) : null;
  const chooser =
    lists[field.kind]?.tools?.(
      field.label,
      (text) => {
        input.value = text;
        input.dispatchEvent(new Event("input"));
        input.dispatchEvent(new Event("change"));
      },
      (message) => draft(message),
    ) ?? [];
  const box = element("div", { class: "box" }, input, ...(unitSelect ? [unitSelect] : unit ? [unit] : []), ...chooser);
  const root = element(
    "div",
    { class: wide ? "field wide" : "field" },
    termButton(field.label, field.term, { id: `${id}-label`, tabindex: "-1" }),
    box,
    also,
    hint,
    error,
  );

  /** @type {any} */
  let value;
  /** @type {string | null} What stands in the field and means `value`, though written otherwise. */
  let typed = null;

  /** @param {any} next */
  function edit(next) {
    typed = input.value;
    dispatch({ type: "edit", path, value: next, joins: true });
  }
  /** @param {string} message */
  const draft = (message) => dispatch({ type: "draft", path, text: input.value, message });

  input.addEventListener(field.kind === "choice" ? "change" : "input", () => {
    const result = read(input.value, field, now(), value);
    if ("message" in result) draft(result.message);
    else edit(result.value);
  });
  input.addEventListener("change", () => {
    // A box of cycles shows cycles: a time that was typed is what it comes to, and stands beside it.
    if (field.kind.endsWith("cycles") && !(path in now().drafts)) {
      typed = null;
      input.value = print(get(now().scenario, path), field);
    }
    dispatch({ type: "committed" });
  });
  unitSelect?.addEventListener("change", () => {
    typed = null;
    dispatch({ type: "edit", path, value: convert(value, unitSelect.value, path, now()) });
  });

  /** A field without use stays away, unless what is wrong is in it. @param {State} state */
  function place({ scenario }) {
    const { when } = field;
    const beside = when && (when.path ?? path.slice(0, path.length - field.key.length) + when.key);
    root.hidden = when !== undefined && get(scenario, beside ?? "") !== when.is && error.textContent === "";
  }

  return {
    root,
    label: field.label,
    show(given, state) {
      const next = given === undefined ? field.initial : given;
      place(state);
      const was = value;
      value = next;
      const drafted = state.drafts[path];
      const text = drafted?.text ?? print(next, field);
      const known = typed !== null ? read(typed, field, state, next) : null;
      if (known && "value" in known && same(known.value, next) && input.value === typed) {
        // The visitor's own way of writing this value stays.
      } else if (input.value !== text) {
        input.value = text;
        typed = null;
        if (was !== undefined && document.activeElement !== input) flash(input);
      }
      root.classList.toggle("long", !wide && input.value.length > LONG);
      if (unitSelect && next && typeof next === "object") unitSelect.value = Object.keys(next)[0];
      say(also, meaning(next, field, state));
    },
    fail(message) {
      say(error, message);
      place(now());
      if (message) input.setAttribute("aria-invalid", "true");
      else input.removeAttribute("aria-invalid");
    },
    focus() {
      for (let at = root.parentElement; at; at = at.parentElement) if (at instanceof HTMLDetailsElement) at.open = true;
      input.focus();
    },
  };
}

/** Whether a field holds a list whose way of typing loads with the first of them. @param {Field} field */
export function isList({ kind }) {
  return kind === "wholes" || kind === "segments" || kind === "points";
}

/** @param {any} a @param {any} b */
function same(a, b) {
  return a === b || (typeof a === "object" && JSON.stringify(a) === JSON.stringify(b));
}

/** @param {any} value @param {Field} field */
function print(value, field) {
  if (value === null || value === undefined) return "";
  if (field.kind === "quantity") return String(Object.values(value)[0]);
  if (field.kind === "lines") return value.map(spaced).join("\n");
  const list = lists[field.kind];
  if (list) return list.print(value);
  return isHex(field) ? spaced(value) : String(value);
}

/** @param {Field} field */
function isHex({ kind }) {
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

/** @param {string} text @param {Field} field @param {State} state @param {any} before @returns {{value: any} | {message: string}} */
function read(text, field, state, before) {
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
      return parseNumber(text, unit === "°" || unit.includes(" ") ? "" : unit);
    default:
      return parseNumber(text, unit, { integer: true, clockHz });
  }
}

/** `250 mm` also chooses the unit. @param {string} text @param {Field} field @param {any} before @returns {{value: any} | {message: string}} */
function readQuantity(text, field, before) {
  const units = field.units ?? {};
  const chosen = Object.keys(before ?? units)[0];
  const named = Object.entries(units).find(([name, printed]) => {
    const tail = text.trim().match(/[^\d.,\s+−-].*$/)?.[0] ?? "";
    return (
      tail === printed ||
      tail === name ||
      tail === printed.replace("²", "2").replace("³", "3") ||
      tail === printed.replace("°", "deg")
    );
  });
  const unit = named?.[0] ?? chosen;
  const result = parseNumber(named ? text.trim().replace(/[^\d.,\s+−-].*$/, "") : text, units[chosen] ?? "");
  return "message" in result ? result : { value: { [unit]: result.value } };
}

/** A quantity in another unit, the same way where the mechanics are known. @param {any} value @param {string} to @param {string} path @param {State} state */
function convert(value, to, path, state) {
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
function meaning(value, field, state) {
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
