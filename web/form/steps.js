/** Numbers change without typing: arrow keys in the input, dragging its label, and a slider for a short range. */
import { element } from "../dom.js";
import { registerCommands } from "../shell/commands.js";
import { createScrub, FAST } from "../state/drag.js";
import { added, caretAt, placeAt, scrubPlace, stepped } from "../state/step_number.js";
import { hasSlider, limitsOf, sliderRange } from "./limits.js";
import { createLiveEdit } from "./live_edit.js";
import { read } from "./values.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("./field.js").Field} Field */

const NUMBERS = /^(number|integer|quantity|cycles|optional(-number|-cycles|-quantity)?)$/;

/**
 * Adds keys, scrubbing and a slider to a field with a number.
 * @param {string} path @param {Field} field
 * @param {{input: HTMLInputElement, label: HTMLElement, value: () => any, retype: (text: string) => void,
 *   dispatch: (message: import("../state/message.js").Message) => void, now: () => State}} parts  `value`: the current value.
 *   `retype` shows a text as if it had been typed for the value.
 * @returns {{slider: HTMLInputElement | null, isActive: () => boolean, show: (value: any, state: State) => void} | null}  null if
 *   it is not a number. `isActive`: the input shows a pending edit.
 */
export function addSteps(path, field, { input, label, value, retype, dispatch, now }) {
  if (!NUMBERS.test(field.kind)) return null;
  const isInteger = /integer|cycles|optional$/.test(field.kind);
  const live = createLiveEdit(input, { dispatch, now });
  // Presses of keys without typing between them are one step of undo.
  const repeated = createLiveEdit(input, { dispatch, now }, { commits: false });
  /** @param {string} text */
  function enter(text) {
    input.value = text;
    input.dispatchEvent(new Event("input"));
  }
  /** Shows a text at once, and enters it when the page is ready. @param {ReturnType<typeof createLiveEdit>} by @param {string} text */
  function follow(by, text) {
    input.value = text;
    by.edit(() => enter(text));
  }

  /** A text within the limits of the field, and whether it is at one of them; null if it is not a number. @param {string | null} text */
  function limited(text) {
    const result = text === null ? { message: "" } : read(text, field, now(), value());
    if (text === null || "message" in result) return null;
    const { min, max } = limitsOf(field, path, now().scenario);
    if (result.value <= min) return { text: result.value < min ? String(min) : text, isLimit: true };
    if (result.value >= max) return { text: result.value > max ? String(max) : text, isLimit: true };
    return { text, isLimit: false };
  }

  /** The last step, while the caret stays. @type {import("../state/step_number.js").Stepped | null} */
  let last = null;
  /** @param {number} by @param {KeyboardEvent} event */
  function step(by, { repeat }) {
    if (!repeat) repeated.end();
    const caret = input.selectionEnd ?? input.value.length;
    const isSame = last?.text === input.value && last.caret === caret;
    const place = isSame ? last?.place : (placeAt(input.value, caret) ?? 0);
    const next = stepped(input.value, caret, by, place, limited(input.value)?.isLimit);
    const text = limited(next?.text ?? null)?.text;
    if (!next || text === undefined) return;
    if (!last) dispatch({ type: "committed" });
    last = { ...next, text, caret: caretAt(text, next.place) };
    if (repeat) follow(repeated, text);
    else enter(text);
    input.setSelectionRange(last.caret, last.caret);
  }
  for (const event of ["keyup", "beforeinput", "blur"]) input.addEventListener(event, repeated.end);
  for (const event of ["beforeinput", "blur"])
    input.addEventListener(event, () => {
      if (last) dispatch({ type: "committed" });
      last = null;
    });
  registerCommands(input, "Field with a number", [
    { keys: ["ArrowUp"], text: "increase the digit before the cursor", run: (event) => step(1, event) },
    { keys: ["ArrowDown"], text: "decrease the digit before the cursor", run: (event) => step(-1, event) },
    { keys: ["Shift+ArrowUp", "PageUp"], text: "increase the digit by ten", run: (event) => step(FAST, event) },
    { keys: ["Shift+ArrowDown", "PageDown"], text: "decrease the digit by ten", run: (event) => step(-FAST, event) },
  ]);

  /** @type {{scrub: ReturnType<typeof createScrub>, text: string, place: number} | null} */
  let drag = null;
  let wasMoved = false;
  label.classList.add("scrub");
  label.addEventListener("pointerdown", (event) => {
    wasMoved = false;
    const place = scrubPlace(input.value, isInteger);
    if (event.button !== 0 || place === null || limited(input.value) === null) return;
    drag = { scrub: createScrub(event), text: input.value, place };
    label.setPointerCapture(event.pointerId);
  });
  label.addEventListener("pointermove", (event) => {
    const by = drag?.scrub.move(event) ?? null;
    if (!drag || by === null) return;
    wasMoved = true;
    const text = limited(added(drag.text, drag.place, by))?.text;
    if (text !== undefined && text !== input.value) follow(live, text);
  });
  // The browser scrolls instead.
  label.addEventListener("pointercancel", () => {
    if (drag?.scrub.isMoved()) retype(drag.text);
    drag = null;
    wasMoved = false;
    live.cancel();
  });
  label.addEventListener("lostpointercapture", () => {
    drag = null;
    live.end();
  });
  // The click at the end of a drag must not open the help card.
  label.addEventListener("click", (event) => {
    if (wasMoved) event.stopPropagation();
    wasMoved = false;
  });

  const slider = hasSlider(field)
    ? element("input", { type: "range", tabindex: "-1", "aria-label": `${field.label}, slider` })
    : null;
  slider?.addEventListener("input", () => follow(live, limited(slider.value)?.text ?? slider.value));
  slider?.addEventListener("change", live.end);

  return {
    slider,
    isActive: () => live.isActive() || repeated.isActive(),
    show(shown, state) {
      if (!slider) return;
      const limits = limitsOf(field, path, state.scenario);
      slider.disabled = !Number.isFinite(limits.max);
      const range = sliderRange(limits, isInteger);
      [slider.min, slider.max, slider.step] = [range.min, range.max, range.step].map(String);
      slider.value = String(shown);
    },
  };
}
