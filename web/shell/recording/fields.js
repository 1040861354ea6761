/** Fields of the dialog of a recording, with their errors. */
import { element } from "../../dom.js";
import { parseNumber } from "../../state/parse_number.js";

/** Largest number that a field takes: what the core has room for. */
const MAX = 2 ** 32 - 1;

/**
 * A field, its label and its error: of what is typed, or of what the core reports of it.
 * @param {string} name @param {string} unit @param {HTMLInputElement | HTMLSelectElement} input @param {() => string} check  What is wrong with it.
 */
function labeled(name, unit, input, check) {
  const id = `recording-${name.toLowerCase().replaceAll(" ", "-")}`;
  input.id = id;
  input.setAttribute("aria-describedby", `${id}-error`);
  const error = element("span", { class: "error", id: `${id}-error`, "aria-live": "polite" });
  const fail = (/** @type {string} */ text) => {
    error.textContent = text;
    input.setAttribute("aria-invalid", String(text !== ""));
  };
  input.addEventListener("input", () => fail(check()));
  const label = element("div", {}, element("label", { for: id }, `${name}${unit && ", "}${unit} `), input, error);
  return { label, fail, isWrong: () => check() !== "" };
}

/** @param {string} placeholder */
const typed = (placeholder) => element("input", { type: "text", placeholder, size: "16" });

/** A whole number that may be left empty. @param {string} name @param {string} unit @param {string} empty @param {number} [least] */
export function numberField(name, unit, empty, least = 1) {
  const input = typed(empty);
  /** @returns {{value: number} | {message: string}} */
  const read = () => {
    if (input.value.trim() === "") return { value: 0 };
    const read = parseNumber(input.value, unit, { integer: true });
    const fits = "message" in read || (read.value >= least && read.value <= MAX);
    return fits
      ? read
      : { message: `${input.value.trim()} is out of range; use ${least} to ${MAX}${unit && " "}${unit}.` };
  };
  const check = () => {
    const found = read();
    return "message" in found ? found.message : "";
  };
  return {
    ...labeled(name, unit, input, check),
    value: () => {
      const found = read();
      return "value" in found ? found.value : 0;
    },
    set: (/** @type {number} */ value) => {
      input.value = String(value);
    },
  };
}

/** A time that may be left empty. @param {string} name @param {string} empty */
export function timeField(name, empty) {
  const input = typed(empty);
  /** @returns {{value: number | null} | {message: string}} */
  const read = () => {
    if (input.value.trim() === "") return { value: null };
    const read = parseNumber(input.value, "s");
    return "message" in read || read.value >= 0
      ? read
      : { message: `${input.value.trim()} is out of range; use 0 s or more.` };
  };
  const check = () => {
    const found = read();
    return "message" in found ? found.message : "";
  };
  return {
    ...labeled(name, "s", input, check),
    value: () => {
      const found = read();
      return "value" in found ? found.value : null;
    },
    set: (/** @type {number | null} */ value) => {
      input.value = value === null ? "" : `${value}`;
      input.dispatchEvent(new Event("input"));
    },
  };
}

/** A text that may be left empty. @param {string} name @param {string} placeholder */
export function textField(name, placeholder) {
  const input = element("input", { type: "text", placeholder, size: "40" });
  return {
    ...labeled(name, "", input, () => ""),
    value: () => input.value.trim(),
    set: (/** @type {string} */ value) => {
      input.value = value;
    },
  };
}

/** One of several values, the first by itself. @param {string} name @param {[string, string][]} values */
export function choiceField(name, values) {
  const input = element("select", {}, ...values.map(([value, text]) => element("option", { value }, text)));
  return {
    ...labeled(name, "", input, () => ""),
    value: () => input.value,
    set: (/** @type {string} */ value) => {
      input.value = value;
    },
  };
}
