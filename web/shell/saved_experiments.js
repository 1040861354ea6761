/** Opens the panel of saved experiments (experiments.js), with the name of the experiment selected. */
import { byId } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { readJson } from "../state/json.js";
import { createLazyPopover } from "./lazy_popover.js";

/** Shows a saved experiment. The core reads it, since an earlier version may have saved it. @param {Pick<import("./experiments.js").Given, "engine" | "dispatch">} page @param {any} saved */
export async function openSaved({ engine, dispatch }, saved) {
  const read = await engine.request("check", JSON.stringify(saved)).catch(unlessDropped);
  if (read) dispatch({ type: "replace", scenario: readJson(read.scenario), origin: "own" });
}

/** @param {import("./experiments.js").Given} page */
export function createSavedExperiments(page) {
  const panel = byId("experiments-panel");
  const name = /** @type {HTMLInputElement} */ (byId("experiment-name"));
  // The name can be typed before the rest of the panel is loaded.
  panel.addEventListener("beforetoggle", () => {
    name.value = String(page.now().scenario.title ?? "");
  });
  panel.addEventListener("toggle", () => name.select());
  return createLazyPopover(
    "experiments",
    "experiments-panel",
    async ({ close }) =>
      (await import("./experiments.js")).createExperiments(page, { close, open: (saved) => openSaved(page, saved) }),
    "experiment-about",
  );
}
