/** Number fields and choices of the study. */
import { element, setText } from "../../dom.js";
import { parseNumber } from "../../state/parse_number.js";

let fieldCount = 0;

/**
 * A field for a number. `onChange` is called with each valid change.
 * @param {string} label @param {string} unit @param {number} start @param {{min: number, max: number, integer?: boolean}} range @param {() => void} onChange
 */
export function field(label, unit, start, { min, max, integer = false }, onChange) {
  const id = `study-field-${fieldCount++}`;
  const input = element("input", {
    id,
    inputmode: "decimal",
    spellcheck: "false",
    autocomplete: "off",
    value: String(start),
    "aria-describedby": `${id}-error`,
  });
  const error = element("span", { id: `${id}-error`, class: "error" });
  const root = element(
    "span",
    { class: "study-field" },
    element("label", { for: id }, unit ? `${label}, ${unit}` : label),
    input,
    error,
  );
  let value = start;
  /** Error of the typed text, and error that `fail` has set. */
  let [textError, valueError] = ["", ""];
  const showError = () => {
    setText(error, textError || valueError);
    if (textError || valueError) input.setAttribute("aria-invalid", "true");
    else input.removeAttribute("aria-invalid");
  };
  input.addEventListener("change", () => {
    const read = parseNumber(input.value, unit, { integer, min, max });
    textError =
      "message" in read
        ? read.message
        : read.value >= min && read.value <= max
          ? ""
          : `${input.value.trim()} is out of range; use ${min} to ${max}.`;
    showError();
    if (textError || !("value" in read) || read.value === value) return;
    value = read.value;
    onChange();
  });
  /** @param {number} next */
  const set = (next) => {
    // An unchanged value keeps the typed text.
    if (next === value) return;
    value = next;
    input.value = String(next);
    [textError, valueError] = ["", ""];
    showError();
  };
  /** @param {string} message */
  const fail = (message) => {
    valueError = message;
    showError();
  };
  return { root, value: () => value, set, fail };
}

/** A select. @param {string} label @param {{[value: string]: string}} choices @param {() => void} onChange */
export function choice(label, choices, onChange) {
  const select = element(
    "select",
    {},
    ...Object.entries(choices).map(([value, text]) => element("option", { value }, text)),
  );
  select.addEventListener("change", onChange);
  return { root: element("label", {}, `${label} `, select), value: () => select.value };
}
