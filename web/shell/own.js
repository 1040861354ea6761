/** The visitor's own experiments among the presets, and the button of their panel, which loads when it is first opened. */
import { byId, element } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { readJson } from "../state/json.js";
import { createLazyPopover } from "./lazy_popover.js";
import { loadExperiments } from "./storage.js";

/** Lists the own experiments beside the presets. */
function listOwn() {
  const preset = /** @type {HTMLSelectElement} */ (byId("preset"));
  const { value } = preset;
  preset.querySelector("optgroup[data-own]")?.remove();
  const own = loadExperiments().map(({ title }) => element("option", { value: `own:${title}` }, title));
  if (own.length > 0)
    preset.firstElementChild?.after(element("optgroup", { label: "Your own", "data-own": "" }, ...own));
  preset.value = value;
}

/** Shows an own experiment: an earlier version may have kept it, so the core reads it. @param {import("./experiments.js").Given} page @param {any} saved */
async function openOwn({ engine, dispatch }, saved) {
  const read = await engine.ask("check", JSON.stringify(saved)).catch(unlessDropped);
  if (read) dispatch({ type: "replace", scenario: readJson(read.scenario), origin: "own" });
}

/** @param {import("./experiments.js").Given} page */
export function createOwn(page) {
  const panel = createLazyPopover(
    "experiments",
    "experiments-panel",
    async ({ close }) =>
      (await import("./experiments.js")).createExperiments(page, {
        close,
        changed: listOwn,
        open: (saved) => openOwn(page, saved),
      }),
    "experiment-about",
  );
  byId("preset").addEventListener("change", () => {
    const { value } = /** @type {HTMLSelectElement} */ (byId("preset"));
    const scenario = loadExperiments().find(({ title }) => `own:${title}` === value);
    if (scenario) openOwn(page, scenario);
  });
  listOwn();
  return panel;
}
