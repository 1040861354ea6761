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
  /** The title that the field last showed, and the number of its experiment. */
  let [shown, of] = ["", -1];
  // The name can be typed before the rest of the panel is loaded. It stays until another experiment is opened.
  panel.addEventListener("beforetoggle", (event) => {
    const { scenario, opened } = page.now();
    const title = String(scenario.title ?? "");
    const isOpen = /** @type {ToggleEvent} */ (event).newState === "open";
    if (isOpen && (name.value === shown || opened !== of)) [name.value, of] = [title, opened];
    if (name.value === title) shown = title;
  });
  panel.addEventListener("toggle", (event) => {
    if (/** @type {ToggleEvent} */ (event).newState === "open") name.select();
  });
  return createLazyPopover(
    "experiments",
    "experiments-panel",
    async ({ close }) =>
      (await import("./experiments.js")).createExperiments(page, { close, open: (saved) => openSaved(page, saved) }),
    "experiment-about",
  );
}
