/** The baseline of the motion view. */
import { button, byId } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createCompare({ engine, dispatch, now }) {
  const place = byId("compared");
  const keepButton = /** @type {HTMLButtonElement} */ (byId("keep-run"));
  const change = /** @type {HTMLInputElement} */ (byId("show-difference"));
  const drop = button("Clear baseline", "Clear the baseline", () => {
    dispatch({ type: "baseline", baseline: null });
    keepButton.focus();
  });
  [drop.className, drop.hidden] = ["with-baseline", true];
  byId("baseline-buttons").append(drop);
  keepButton.addEventListener("click", () => void keep());
  change.addEventListener("change", () => dispatch({ type: "difference", on: change.checked }));

  async function keep() {
    const { result, scenario, derived, origin, revision } = now();
    // What is kept is what the worker has: only a run of the scenario in the form.
    if (!result || result.revision !== revision || !(await engine.request("baseline", true).catch(unlessDropped)))
      return;
    const title =
      scenario.title ||
      (origin.startsWith("preset:")
        ? origin.slice(7)
        : `of digest ${result.summary.controllers[result.controller].digest.slice(0, 8)}`);
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
    place.hidden = !state.baseline;
    if (!state.baseline || !state.result) return;
    const { showCompared } = await import("./compared.js");
    await showCompared(engine, state);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    keepButton.disabled = state.result === null || state.result.revision !== state.revision;
    const { baseline, result, axis, unit, derived } = state;
    if (before?.baseline !== baseline) {
      if (before?.baseline && !baseline) engine.request("baseline", false).catch(unlessDropped);
      for (const node of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll(".with-baseline")))
        node.hidden = !baseline;
      keepButton.textContent = baseline ? "Set as new baseline" : "Set as baseline";
    }
    change.checked = state.difference;
    if (
      before?.baseline !== baseline ||
      (baseline &&
        (before?.result !== result || before?.axis !== axis || before?.unit !== unit || before?.derived !== derived))
    )
      void showDifference(state).catch(unlessDropped);
  }
  return { render };
}
