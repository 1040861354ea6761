/** Numbers change without typing: arrow keys in the input, dragging its label, and a slider for a short range. */
import { element } from "../dom.js";
import { registerCommands } from "../shell/commands.js";
import { added, caretAt, placeAt, scrubPlace, stepped } from "../state/step_number.js";
import { hasSlider, limitsOf, sliderStep } from "./limits.js";
import { createLiveEdit } from "./live_edit.js";
import { read } from "./values.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("./field.js").Field} Field */

/** A drag that moves less is a click, and the distance of one step, in CSS pixels. */
const STEP_PX = 4;
/** Steps with Shift. */
const FAST = 10;
const NUMBERS = /^(number|integer|quantity|cycles|optional(-number|-cycles|-quantity)?)$/;

/**
 * Adds keys, scrubbing and a slider to a field with a number.
 * @param {string} path @param {Field} field
 * @param {{input: HTMLInputElement, label: HTMLElement, value: () => any, dispatch: (message: import("../state/message.js").Message) => void,
 *   now: () => State}} parts  `value`: the current value.
 * @returns {{slider: HTMLInputElement | null, show: (value: any, state: State) => void} | null}  null if it is not a number.
 */
export function addSteps(path, field, { input, label, value, dispatch, now }) {
  if (!NUMBERS.test(field.kind)) return null;
  const isInteger = /integer|cycles|optional$/.test(field.kind);
  const live = createLiveEdit(dispatch);
  const enter = () => input.dispatchEvent(new Event("input"));

  /** A text within the limits of the field; null if it is not a number. @param {string | null} text */
  function limited(text) {
    const result = text === null ? { message: "" } : read(text, field, now(), value());
    if ("message" in result) return null;
    const { min, max } = limitsOf(field, path, now().scenario);
    return result.value < min ? String(min) : result.value > max ? String(max) : text;
  }

  /** The last step, while the caret stays. @type {import("../state/step_number.js").Stepped | null} */
  let last = null;
  /** @param {number} by */
  function step(by) {
    const caret = input.selectionEnd ?? input.value.length;
    const isSame = last?.text === input.value && last.caret === caret;
    const next = stepped(input.value, caret, by, isSame ? last?.place : (placeAt(input.value, caret) ?? 0));
    const text = limited(next?.text ?? null);
    if (!next || text === null) return;
    // Presses without typing between them are one step of undo.
    if (!last) dispatch({ type: "committed" });
    last = { ...next, text, caret: caretAt(text, next.place) };
    input.value = text;
    enter();
    input.setSelectionRange(last.caret, last.caret);
  }
  for (const event of ["beforeinput", "blur"])
    input.addEventListener(event, () => {
      if (last) dispatch({ type: "committed" });
      last = null;
    });
  registerCommands(input, "Field with a number", [
    { keys: ["ArrowUp"], text: "increase the digit before the cursor", run: () => step(1) },
    { keys: ["ArrowDown"], text: "decrease it", run: () => step(-1) },
    { keys: ["Shift+ArrowUp", "PageUp"], text: "increase it by ten", run: () => step(FAST) },
    { keys: ["Shift+ArrowDown", "PageDown"], text: "decrease it by ten", run: () => step(-FAST) },
  ]);

  /** @type {{x: number, text: string, place: number, moved: boolean} | null} */
  let drag = null;
  let wasMoved = false;
  label.classList.add("scrub");
  label.addEventListener("pointerdown", (event) => {
    wasMoved = false;
    const place = scrubPlace(input.value, isInteger);
    if (event.button !== 0 || place === null || limited(input.value) === null) return;
    drag = { x: event.clientX, text: input.value, place, moved: false };
    label.setPointerCapture(event.pointerId);
  });
  label.addEventListener("pointermove", ({ clientX, shiftKey }) => {
    if (!drag || (!drag.moved && Math.abs(clientX - drag.x) < STEP_PX)) return;
    drag.moved = true;
    const by = Math.trunc((clientX - drag.x) / STEP_PX) * (shiftKey ? FAST : 1);
    const text = limited(added(drag.text, drag.place, by));
    if (text !== null && text !== input.value) input.value = text;
    live.edit(enter);
  });
  for (const event of ["pointerup", "pointercancel"])
    label.addEventListener(event, () => {
      wasMoved = drag?.moved ?? false;
      drag = null;
      live.end();
    });
  // The click at the end of a drag must not open the help card.
  label.addEventListener("click", (event) => wasMoved && event.stopPropagation());

  const slider = hasSlider(field)
    ? element("input", { type: "range", tabindex: "-1", "aria-label": `${field.label}, slider` })
    : null;
  slider?.addEventListener("input", () => {
    input.value = slider.value;
    live.edit(enter);
  });
  slider?.addEventListener("change", live.end);

  return {
    slider,
    show(shown, state) {
      if (!slider) return;
      const limits = limitsOf(field, path, state.scenario);
      slider.disabled = !Number.isFinite(limits.max);
      [slider.min, slider.max] = [limits.min, limits.max].map(String);
      slider.step = String(sliderStep(limits, isInteger));
      slider.value = String(shown);
    },
  };
}
