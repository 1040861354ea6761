/** Opens presets, sample recordings and saved experiments. */
import { byId } from "../dom.js";
import { awaitResult } from "../shell/await_result.js";
import { openSaved } from "../shell/saved_experiments.js";
import { parseView } from "../shell/view_part.js";
import { errorMessage } from "../state/error_message.js";
import { readJson } from "../state/json.js";

/** @typedef {{engine: import("../engine/engine.js").Engine, problemText: import("../shell/open_file.js").ProblemText, presets: import("../state/types.js").Preset[]} & import("../state/types.js").Page} Page */

/** Makes a view visible: unfolded and scrolled to on a wide screen, and above a folded form on a narrow one. @param {Page} page @param {string} view */
export async function reveal({ dispatch, now }, view) {
  const { largest, folded } = now().panes;
  if (largest !== null || folded.some((name) => name === view))
    dispatch({ type: "pane", panes: { largest: null, folded: folded.filter((name) => name !== view) } });
  if (matchMedia("(max-width: 899px)").matches) {
    /** @type {HTMLDetailsElement} */ (byId("sheet")).open = false;
    scrollTo(0, 0);
  } else if (await awaitResult({ now })) {
    // Views that load, such as the spectrum, have their height once they are drawn.
    await new Promise((drawn) => {
      const { dataset } = document.documentElement;
      const check = () => (dataset.state === "busy" ? requestAnimationFrame(check) : drawn(null));
      check();
    });
    byId(`view-${view}`).scrollIntoView({ block: "nearest" });
  }
}

/** Opens a preset in its view, or in another one. @param {Page} page @param {import("../state/types.js").Preset} preset @param {string} [view]  Part `v` of a link. */
export function openPreset(page, { id, scenario, view: own }, view = own) {
  const part = parseView(view);
  page.dispatch({ type: "replace", scenario: readJson(scenario), origin: `preset:${id}` });
  page.dispatch({ type: "open", view: part });
  void reveal(page, part.view ?? "motion");
}

/** @param {Page} page @param {import("../state/gallery.js").Entry} entry */
export async function openEntry(page, { id, title, preset, saved }) {
  try {
    if (preset) openPreset(page, preset);
    else if (saved) await openSaved(page, saved);
    else await (await import("../shell/recording/recording.js")).openRecording(page, id);
  } catch (error) {
    const text = `“${title}” cannot be opened: ${errorMessage(error)}`;
    page.dispatch({ type: "notice", notice: { kind: "error", text, location: null } });
  }
}
