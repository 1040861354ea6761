/** Lists saved experiments among the presets, and opens their panel. */
import { byId, element } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { readJson } from "../state/json.js";
import { createLazyPopover } from "./lazy_popover.js";
import { loadExperiments } from "./storage.js";

/** Lists the saved experiments before the presets. */
function listSaved() {
  const preset = /** @type {HTMLSelectElement} */ (byId("preset"));
  const { value } = preset;
  preset.querySelector("optgroup[data-saved]")?.remove();
  const saved = loadExperiments().map(({ title }) => element("option", { value: `own:${title}` }, title));
  if (saved.length > 0)
    preset.firstElementChild?.after(element("optgroup", { label: "My experiments", "data-saved": "" }, ...saved));
  preset.value = value;
}

/** Shows a saved experiment. The core reads it, since an earlier version may have saved it. @param {import("./experiments.js").Given} page @param {any} saved */
async function openSaved({ engine, dispatch }, saved) {
  const read = await engine.request("check", JSON.stringify(saved)).catch(unlessDropped);
  if (read) dispatch({ type: "replace", scenario: readJson(read.scenario), origin: "own" });
}

/** @param {import("./experiments.js").Given} page */
export function createSavedExperiments(page) {
  const panel = createLazyPopover(
    "experiments",
    "experiments-panel",
    async ({ close }) =>
      (await import("./experiments.js")).createExperiments(page, {
        close,
        changed: listSaved,
        open: (saved) => openSaved(page, saved),
      }),
    "experiment-about",
  );
  byId("preset").addEventListener("change", () => {
    const { value } = /** @type {HTMLSelectElement} */ (byId("preset"));
    const scenario = loadExperiments().find(({ title }) => `own:${title}` === value);
    if (scenario) openSaved(page, scenario);
  });
  listSaved();
  return panel;
}
