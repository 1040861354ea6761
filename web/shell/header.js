/** Undo and redo, the state of the run in header and footer, and the messages below the header. */

import { byId, setOptions, setText } from "../dom.js";
import { si } from "../state/number.js";
import { blockedBy, isStale, selected } from "../state/queries.js";
import { registerCommands } from "./commands.js";
import { createHealth } from "./health.js";
import { statusText } from "./run_texts.js";

/** @typedef {import("../state/types.js").State} State */

/** Progress is shown only for runs longer than this, in ms. */
const PROGRESS_DELAY_MS = 90;

/** @param {{cancel: () => void, retry: () => void, engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} page */
export function createHeader({ cancel, retry, ...page }) {
  const { dispatch } = page;
  const health = createHealth(page);
  const controller = /** @type {HTMLSelectElement} */ (byId("controller"));
  const undo = /** @type {HTMLButtonElement} */ (byId("undo"));
  const redo = /** @type {HTMLButtonElement} */ (byId("redo"));
  const progress = /** @type {HTMLProgressElement} */ (byId("progress"));
  let phaseStart = 0;

  controller.addEventListener("change", () => dispatch({ type: "controller", controller: Number(controller.value) }));
  undo.addEventListener("click", () => dispatch({ type: "undo" }));
  redo.addEventListener("click", () => dispatch({ type: "redo" }));
  byId("run-anyway").addEventListener("click", () => dispatch({ type: "approve" }));
  byId("cancel").addEventListener("click", cancel);
  byId("try-again").addEventListener("click", retry);
  registerCommands(document, "Everywhere", [
    { keys: ["Ctrl+z"], text: "undo", run: (event) => (isOutsideForm(event) ? false : dispatch({ type: "undo" })) },
    {
      keys: ["Ctrl+Shift+z", "Ctrl+y"],
      text: "redo",
      run: (event) => (isOutsideForm(event) ? false : dispatch({ type: "redo" })),
    },
  ]);

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    undo.disabled = state.past.length === 0 && Object.keys(state.drafts).length === 0;
    redo.disabled = state.future.length === 0;
    if (before?.run.phase !== state.run.phase) phaseStart = performance.now();
    const running = state.run.phase === "running";
    const long = running && state.run.progress !== null && performance.now() - phaseStart > PROGRESS_DELAY_MS;
    progress.hidden = !long;
    byId("cancel").hidden = !long;
    if (state.run.progress) progress.value = state.run.progress.cycle / Math.max(1, state.run.progress.end_cycle);
    const text = statusText(state, long);
    setText(byId("status"), text);
    if (byId("status").title !== text) byId("status").title = text;
    setText(
      byId("computed"),
      state.result && !state.result.summary.recorded && !long && blockedBy(state) !== "problems"
        ? `computed in ${si(state.result.ms / 1000, "s", 2)}`
        : "",
    );
    byId("on-show").hidden = !state.result?.summary.recorded;
    health.render(state);
    chooser(state);
    setText(byId("digest"), selected(state)?.digest ?? "–");
    byId("digest").classList.toggle("stale", isStale(state));
    messages(state);
    document.title = state.scenario.title ? `${state.scenario.title} – Stepscope` : "Stepscope";
  }

  /** The controllers on the line, if there are several. @param {State} state */
  function chooser({ result }) {
    const controllers = result?.summary.controllers ?? [];
    setOptions(
      controller,
      controllers.map(({ address }, index) => [String(index), `${index + 1}, address ${address ?? "none"}`]),
      String(result?.controller ?? 0),
    );
    /** @type {HTMLElement} */ (controller.parentElement).hidden = controllers.length < 2;
  }

  return { render };
}

/** Whether a key is typed into a text field outside of the form. @param {KeyboardEvent} event */
function isOutsideForm({ target }) {
  return target instanceof Element && target.matches("input, textarea") && !target.closest("#form");
}

/** @param {State} state */
function messages(state) {
  const over = blockedBy(state) === "budget";
  const budget = byId("budget");
  budget.hidden = !over;
  setText(
    /** @type {Element} */ (budget.firstElementChild),
    over ? `Not run yet: ${state.validation?.cost?.message ?? "this run takes long."}` : "",
  );
  const failed = byId("engine-message");
  failed.hidden = state.run.phase !== "failed";
  setText(/** @type {Element} */ (failed.firstElementChild), state.run.message);
}
