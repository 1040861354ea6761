/** Fields and buttons of the visible time. */
import { byId, setText } from "../dom.js";
import { time } from "../state/number.js";
import { parseNumber } from "../state/parse_number.js";
import { endOf, shown } from "../state/time_window.js";
import { zoom } from "./timeline.js";

/** @typedef {import("../state/types.js").State} State */

/** @param {import("../state/types.js").Page} page */
export function createRange({ dispatch, now }) {
  const page = { dispatch, now };
  // Other views may have such buttons, too.
  for (const press of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("[data-time]"))) {
    const run = {
      in: () => byId("zoom-in").click(),
      out: () => byId("zoom-out").click(),
      fit: () => byId("zoom-fit").click(),
      back: () => dispatch({ type: "back" }),
      box: () => dispatch({ type: "box", on: !now().box }),
    }[press.dataset.time ?? ""];
    if (run) press.addEventListener("click", run);
  }
  byId("zoom-in").addEventListener("click", () => zoom(page, 0.5, now().cursors.a ?? undefined));
  byId("zoom-out").addEventListener("click", () => zoom(page, 2, now().cursors.a ?? undefined));
  byId("zoom-fit").addEventListener("click", () => dispatch({ type: "window", window: null }));
  for (const id of ["window-start", "window-end"]) byId(id).addEventListener("change", typedWindow);

  function typedWindow() {
    const state = now();
    const clockHz = state.result?.summary.clock_hz ?? 1;
    const [start, end] = ["window-start", "window-end"].map((id) => {
      const input = /** @type {HTMLInputElement} */ (byId(id));
      const read = parseNumber(input.value, "s");
      input.setAttribute("aria-invalid", String("message" in read));
      return read;
    });
    const error = "message" in start ? start.message : "message" in end ? end.message : "";
    if (error || "message" in start || "message" in end) return setText(byId("window-error"), error);
    const last = endOf(state) / clockHz;
    if (start.value < 0) return setText(byId("window-error"), "“from” is out of range; use 0 or more.");
    if (start.value >= last)
      return setText(byId("window-error"), `“from” is out of range; use less than ${time(last)}, the end of the run.`);
    if (end.value <= start.value) return setText(byId("window-error"), "“to” is not after “from”; use a later time.");
    setText(byId("window-error"), "");
    const inRun = (/** @type {number} */ s) => Math.min(Math.max(0, s * clockHz), endOf(state));
    dispatch({ type: "window", window: { start: inRun(start.value), end: inRun(end.value) } });
    fields(now(), true);
  }

  /** @param {State} state @param {boolean} [includesFocused]  Whether to update the focused field, too. */
  function fields(state, includesFocused = false) {
    const { start, end } = shown(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    for (const [id, cycle] of /** @type {[string, number][]} */ ([
      ["window-start", start],
      ["window-end", end],
    ])) {
      const input = /** @type {HTMLInputElement} */ (byId(id));
      if (includesFocused || document.activeElement !== input) input.value = time(cycle / clock);
    }
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.box !== state.box || before?.zooms !== state.zooms) {
      for (const press of document.querySelectorAll("[data-time=box]"))
        press.setAttribute("aria-pressed", String(state.box));
      for (const press of document.querySelectorAll("[data-time=back]")) {
        /** @type {HTMLButtonElement} */ (press).disabled = state.zooms.length === 0;
      }
      document.body.classList.toggle("boxing", state.box);
    }
    if (before?.window === state.window && before?.result === state.result) return;
    fields(state);
    setText(byId("window-error"), "");
  }
  return { render };
}
