/** The header: presets, undo and redo, the state of the run, and the messages below it. */

import { byId, element, fill, setOptions, setText } from "../dom.js";
import { errorMessage } from "../state/error_message.js";
import { readJson } from "../state/json.js";
import { si } from "../state/number.js";
import { blockedBy, isStale, selected } from "../state/queries.js";
import { registerCommands } from "./commands.js";
import { createHealth } from "./health.js";
import { statusText } from "./run_texts.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Preset} Preset */

/** Recordings in the list of presets. */
const RECORDED = [
  ["recorded-step-table", "A step table on an ATmega328P"],
  ["recorded-late-packet", "A packet that arrives too late"],
];

/** Progress is shown only for runs longer than this, in ms. */
const PROGRESS_DELAY_MS = 90;

/** @param {{presets: Preset[], cancel: () => void, retry: () => void, engine: import("../engine/engine.js").Engine, problemText: import("./open_file.js").ProblemText} & import("../state/types.js").Page} page */
export function createHeader({ presets, cancel, retry, ...page }) {
  const { dispatch } = page;
  const health = createHealth(page);
  const preset = /** @type {HTMLSelectElement} */ (byId("preset"));
  const controller = /** @type {HTMLSelectElement} */ (byId("controller"));
  const undo = /** @type {HTMLButtonElement} */ (byId("undo"));
  const redo = /** @type {HTMLButtonElement} */ (byId("redo"));
  const progress = /** @type {HTMLProgressElement} */ (byId("progress"));
  let phaseStart = 0;

  const recorded = RECORDED.map(([id, title]) => element("option", { value: id }, title));
  const recordings = element("optgroup", { label: "Recordings" }, ...recorded);
  fill(preset, element("option", { value: "" }, "Presets…"), ...groups(presets), recordings);
  preset.disabled = false;
  preset.addEventListener("change", () => {
    if (RECORDED.some(([id]) => id === preset.value)) openSample(preset.value);
    const chosen = presets.find(({ id }) => id === preset.value);
    if (chosen) openPreset(chosen);
  });
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

  /** @param {Preset} selected */
  function openPreset({ id, scenario }) {
    try {
      dispatch({ type: "replace", scenario: readJson(scenario), origin: `preset:${id}` });
    } catch (error) {
      preset.value = "";
      refuse("The preset", error);
    }
  }

  /** @param {string} id */
  async function openSample(id) {
    preset.value = "";
    try {
      await (await import("./recording/recording.js")).openRecording(page, id);
    } catch (error) {
      refuse("The recording", error);
    }
  }

  /** @param {string} what @param {unknown} error */
  function refuse(what, error) {
    const text = `${what} cannot be opened: ${errorMessage(error)}`;
    dispatch({ type: "notice", notice: { kind: "error", text, location: null } });
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    undo.disabled = state.past.length === 0 && Object.keys(state.drafts).length === 0;
    redo.disabled = state.future.length === 0;
    const id = state.origin.startsWith("preset:") ? state.origin.slice("preset:".length) : "";
    if (before?.origin !== state.origin) preset.value = id;
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

/** Presets by paper. @param {Preset[]} presets */
function groups(presets) {
  /** @type {Map<string, HTMLOptGroupElement>} */
  const made = new Map();
  for (const { id, document: name, title } of presets) {
    const group = made.get(name) ?? element("optgroup", { label: name || "Examples" });
    made.set(name, group);
    group.append(element("option", { value: id }, title));
  }
  return made.values();
}
