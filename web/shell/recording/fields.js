/** Fields of the dialog of a recording, with their errors. */
import { element } from "../../dom.js";
import { parseNumber } from "../../state/parse_number.js";

/** Maximum value of a field: that of the core's 32-bit numbers. */
const MAX = 2 ** 32 - 1;

/**
 * A field with its label and an error, which is set by a check of the text or by the core.
 * @param {string} name @param {string} unit @param {HTMLInputElement | HTMLSelectElement} input @param {() => string} check  Returns the error; empty if there is none.
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
  return { label, fail, isInvalid: () => check() !== "" };
}

/** @param {string} placeholder */
const textInput = (placeholder) => element("input", { type: "text", placeholder, size: "16" });

/** A whole number that may be left empty. @param {string} name @param {string} unit @param {string} empty  Placeholder of an empty field. @param {number} [min] */
export function numberField(name, unit, empty, min = 1) {
  const input = textInput(empty);
  /** @returns {{value: number} | {message: string}} */
  const read = () => {
    if (input.value.trim() === "") return { value: 0 };
    const read = parseNumber(input.value, unit, { integer: true });
    const fits = "message" in read || (read.value >= min && read.value <= MAX);
    return fits
      ? read
      : { message: `${input.value.trim()} is out of range; use ${min} to ${MAX}${unit && " "}${unit}.` };
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
  const input = textInput(empty);
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

/** A choice; the first value is the default. @param {string} name @param {[string, string][]} values */
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
