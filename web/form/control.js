/** A field of the form: label, input or select, unit, hint and error. Invalid text is dispatched as a draft. */
import { drawInPlace, element, flash, setText } from "../dom.js";
import { get } from "../state/paths.js";
import { addSteps } from "./steps.js";
import { termButton } from "./term_button.js";
import { convert, isHex, isList, isSame, listTools, meaning, print, read } from "./values.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("./field.js").Field} Field */

/**
 * @typedef {object} Control
 * @property {HTMLElement} root
 * @property {string} label
 * @property {(value: any, state: State) => void} show  Shows a value.
 * @property {(value: any, state: State) => void} follow  Shows only the meaning of a value, without a change of layout.
 * @property {(message: string) => void} fail  Shows an error; empty clears it.
 * @property {() => void} focus
 */

/** A longer text moves its input below the label, in characters. */
const MAX_INLINE = 12;
/** The same for a choice, whose letters are narrower than digits on average. */
const MAX_CHOICE = 20;
let count = 0;

/**
 * @param {string} path
 * @param {Field} field
 * @param {{dispatch: (message: import("../state/message.js").Message) => void, now: () => State}} page
 * @returns {Control}
 */
export function control(path, field, { dispatch, now }) {
  const id = `f${count++}`;
  const error = element("p", { class: "error", id: `${id}-error` });
  const hint = element("p", { class: "hint", id: `${id}-hint` }, field.hint);
  const meaningNode = element("span", { class: "also" });
  const labels = { "aria-labelledby": field.unit ? `${id}-label ${id}-unit` : `${id}-label` };
  const inputAttributes = {
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
          inputAttributes,
          ...Object.entries(field.choices ?? {}).map(([value, text]) => element("option", { value }, text)),
        )
      : long
        ? element("textarea", { ...inputAttributes, rows: String(field.rows ?? 4), spellcheck: "false" })
        : element("input", { ...inputAttributes, type: "text", spellcheck: "false" });
  const unitSelect = field.units
    ? element(
        "select",
        { "aria-label": `Unit of ${field.label}`, "data-path": `${path}#unit` },
        ...Object.entries(field.units).map(([value, text]) => element("option", { value }, text)),
      )
    : null;
  const unit = field.unit ? element("span", { class: "unit", id: `${id}-unit` }, field.unit) : null;
  const tools =
    listTools(field)?.(
      field.label,
      (text) => {
        input.value = text;
        input.dispatchEvent(new Event("input"));
        input.dispatchEvent(new Event("change"));
      },
      (message) => draft(message),
    ) ?? [];
  const box = element("div", { class: "box" }, input, ...(unitSelect ? [unitSelect] : unit ? [unit] : []), ...tools);
  const label = termButton(field.label, field.term, { id: `${id}-label`, tabindex: "-1" });
  const steps =
    input instanceof HTMLInputElement
      ? addSteps(path, field, { input, label, value: () => value, retype, dispatch, now })
      : null;
  const root = element(
    "div",
    { class: wide ? "field wide" : "field" },
    label,
    box,
    ...(steps?.slider ? [steps.slider] : []),
    meaningNode,
    hint,
    error,
  );

  /** @type {any} */
  let value;
  /** The text that the user typed for `value`, which may differ from its printed form. @type {string | null} */
  let typed = null;

  /** @param {string} text */
  function retype(text) {
    input.value = typed = text;
  }
  /** @param {any} next */
  function edit(next) {
    typed = input.value;
    dispatch({ type: "edit", path, value: next, joins: true });
  }
  /** @param {string} message */
  const draft = (message) => dispatch({ type: "draft", path, text: input.value, message });

  input.addEventListener(field.kind === "choice" ? "change" : "input", () => {
    const result = read(input.value, field, now(), value ?? (unitSelect && { [unitSelect.value]: 0 }));
    if ("message" in result) draft(result.message);
    else edit(result.value);
  });
  input.addEventListener("change", () => {
    // A typed time is replaced by its cycles.
    if (field.kind.endsWith("cycles") && !(path in now().drafts)) {
      typed = null;
      input.value = print(get(now().scenario, path), field);
    }
    dispatch({ type: "committed" });
  });
  unitSelect?.addEventListener("change", () => {
    typed = null;
    if (!value) return;
    // A text that is no number stays as it was typed.
    dispatch({ type: "edit", path, value: convert(value, unitSelect.value, path, now()), moved: [] });
  });

  /** Hides an unused field, unless it has an error. @param {State} state */
  function updateVisibility({ scenario }) {
    const { when } = field;
    const conditionPath = when && (when.path ?? path.slice(0, path.length - field.key.length) + when.key);
    root.hidden = when !== undefined && get(scenario, conditionPath ?? "") !== when.is && error.textContent === "";
  }

  return {
    root,
    label: field.label,
    show(shownValue, state) {
      const next = shownValue === undefined ? field.initial : shownValue;
      updateVisibility(state);
      const before = value;
      value = next;
      const drafted = state.drafts[path];
      const text = drafted?.text ?? print(next, field);
      const typedValue = typed !== null ? read(typed, field, state, next) : null;
      if (typedValue && "value" in typedValue && isSame(typedValue.value, next) && input.value === typed) {
        // The typed text means this value, so it stays.
      } else if (input.value !== text && !steps?.isActive()) {
        input.value = text;
        typed = null;
        if (before !== undefined && document.activeElement !== input) flash(input);
      }
      const { length } = input instanceof HTMLSelectElement ? (input.selectedOptions[0]?.text ?? "") : input.value;
      root.classList.toggle("long", !wide && length > (input instanceof HTMLSelectElement ? MAX_CHOICE : MAX_INLINE));
      if (unitSelect && next && typeof next === "object") unitSelect.value = Object.keys(next)[0];
      steps?.show(next, state);
      setText(meaningNode, meaning(next, field, state));
    },
    follow(next, state) {
      const text = next === undefined ? "" : meaning(next, field, state);
      if (meaningNode.textContent !== text) drawInPlace(root, meaningNode, () => setText(meaningNode, text));
    },
    fail(message) {
      setText(error, message);
      updateVisibility(now());
      if (message) input.setAttribute("aria-invalid", "true");
      else input.removeAttribute("aria-invalid");
    },
    focus() {
      for (let at = root.parentElement; at; at = at.parentElement) if (at instanceof HTMLDetailsElement) at.open = true;
      input.focus();
    },
  };
}
