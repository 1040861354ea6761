/** The visitor's own experiments among the presets, and the button of their panel, which loads when it is first opened. */
import { byId, element, say } from "../dom.js";
import { dropDown } from "./popover.js";
import { loadExperiments } from "./storage.js";

/** Lists the own experiments beside the presets. */
export function listOwn() {
  const preset = /** @type {HTMLSelectElement} */ (byId("preset"));
  const { value } = preset;
  preset.querySelector("optgroup[data-own]")?.remove();
  const own = loadExperiments().map(({ title }) => element("option", { value: `own:${title}` }, title));
  if (own.length > 0)
    preset.firstElementChild?.after(element("optgroup", { label: "Your own", "data-own": "" }, ...own));
  preset.value = value;
}

/** @param {import("./experiments.js").Given} page */
export function createOwn(page) {
  /** @type {(() => void) | null} */
  let opened = null;
  const { close } = dropDown("experiments", "experiments-panel", async () => {
    try {
      opened ??= (await import("./experiments.js")).createExperiments(page, { close, changed: listOwn });
      opened();
    } catch {
      say(byId("experiment-about"), "This part of the page could not be loaded; try again when the network is there.");
    }
  });
  byId("preset").addEventListener("change", () => {
    const { value } = /** @type {HTMLSelectElement} */ (byId("preset"));
    const scenario = loadExperiments().find(({ title }) => `own:${title}` === value);
    if (scenario) page.dispatch({ type: "replace", scenario, origin: "own" });
  });
  listOwn();
}
