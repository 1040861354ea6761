/** The baseline of the motion view. */
import { button, byId } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createCompare({ engine, dispatch, now }) {
  const root = byId("compared");
  const setButton = /** @type {HTMLButtonElement} */ (byId("keep-run"));
  const differenceBox = /** @type {HTMLInputElement} */ (byId("show-difference"));
  const clearButton = button("Clear baseline", "Clear the baseline", () => {
    dispatch({ type: "baseline", baseline: null });
    setButton.focus();
  });
  [clearButton.className, clearButton.hidden] = ["with-baseline", true];
  byId("baseline-buttons").append(clearButton);
  setButton.addEventListener("click", () => void setBaseline());
  differenceBox.addEventListener("change", () => dispatch({ type: "difference", on: differenceBox.checked }));

  async function setBaseline() {
    const { result, scenario, derived, origin, revision } = now();
    // The worker has the baseline, so it must be the run of the scenario in the form.
    if (!result || result.revision !== revision || !(await engine.request("baseline", true).catch(unlessDropped)))
      return;
    const title =
      scenario.title ||
      (origin.startsWith("preset:")
        ? origin.slice(7)
        : `digest ${result.summary.controllers[result.controller].digest.slice(0, 8)}`);
    dispatch({
      type: "baseline",
      baseline: {
        title,
        revision,
        summary: result.summary,
        controller: result.controller,
        derived: derived?.controllers[result.controller] ?? null,
      },
    });
  }

  /** @param {State} state */
  async function showDifference(state) {
    root.hidden = !state.baseline;
    if (!state.baseline || !state.result) return;
    const { showCompared } = await import("./compared.js");
    await showCompared(engine, state);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    setButton.disabled = state.result === null || state.result.revision !== state.revision;
    const { baseline, result, axis, unit, derived } = state;
    if (before?.baseline !== baseline) {
      if (before?.baseline && !baseline) engine.request("baseline", false).catch(unlessDropped);
      for (const node of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll(".with-baseline")))
        node.hidden = !baseline;
      setButton.textContent = baseline ? "Set as new baseline" : "Set as baseline";
    }
    differenceBox.checked = state.difference;
    if (
      before?.baseline !== baseline ||
      (baseline &&
        (before?.result !== result || before?.axis !== axis || before?.unit !== unit || before?.derived !== derived))
    )
      void showDifference(state).catch(unlessDropped);
  }
  return { render };
}
