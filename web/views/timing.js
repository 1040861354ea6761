/** The timing view: pulses checked against the rules of a driver. */
import { byId, setText } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { registerCommands } from "../shell/commands.js";
import { selected } from "../state/queries.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Timing} Timing */
/** @typedef {ReturnType<typeof import("./timing_results.js").createResults>} Results */

/** @param {{engine: import("../engine/engine.js").Engine, drivers: import("../state/types.js").DriverSheet[], speak: (text: string) => void} & import("../state/types.js").Page} page */
export function createTiming(page) {
  const { engine, speak } = page;
  /** @type {Timing | null} */
  let timing = null;
  /** @type {Promise<Results> | null} */
  let loading = null;

  for (const where of ["", "pulses-"]) {
    byId(`${where}violation-previous`).addEventListener("click", () => next(false));
    byId(`${where}violation-next`).addEventListener("click", () => next(true));
  }
  for (const id of ["pulses", "view-timing"]) {
    registerCommands(byId(id), "Driver timing (pulses and timing)", [
      { keys: ["v"], text: "next violation", run: () => void next(true) },
      { keys: ["Shift+V"], text: "previous violation", run: () => void next(false) },
    ]);
  }

  /** Shows a text in this view and in the pulses. @param {string} text */
  function showNote(text) {
    setText(byId("timing-sentence"), text);
    speak(text);
  }

  /** The results of the check; null if they could not be loaded. */
  async function loadResults() {
    try {
      loading ??= import("./timing_results.js").then(({ createResults }) => createResults({ ...page, showNote }));
      return await loading;
    } catch {
      loading = null;
      showNote("This part of the page could not be loaded. Check the network and try again.");
      return null;
    }
  }

  /** The next violation after cursor A, or after the one that is selected. @param {boolean} forward */
  async function next(forward) {
    if (!timing) return showNote("There is no driver to check.");
    await (await loadResults())?.next(timing, forward);
  }

  /** @param {State} state */
  async function refresh(state) {
    setText(byId("timing-sentence"), "");
    const reply =
      selected(state)?.violations === null ? null : await engine.latest("timing", "timing").catch(unlessDropped);
    if (reply === undefined) return;
    timing = reply;
    // Without a driver the view is hidden.
    if (timing || loading) (await loadResults())?.setTiming(timing);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.result !== state.result) return refresh(state);
    return undefined;
  }
  return { render };
}
