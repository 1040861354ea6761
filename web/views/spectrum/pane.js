/** The pane of the spectrum; loads spectrum.js on demand. */
import { byId, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createSpectrum({ engine, dispatch, now }) {
  const split = byId("spectrum-split");
  const note = byId("spectrum-note");
  /** @type {import("../../state/types.js").Spectra | null} */
  let spectra = null;
  /** The drawn spectra. @type {import("../../state/types.js").Spectra | null} */
  let drawn = null;
  /** The result of the spectra. @type {State["result"]} */
  let spectraResult = null;
  /** @type {ReturnType<typeof import("./spectrum.js").createSpectrumView> | null} */
  let view = null;
  const watcher = new ResizeObserver(() => void refresh(now()));
  for (const node of [byId("view-spectrum"), split]) watcher.observe(node);

  /** @param {State} state */
  async function refresh(state) {
    if (!state.result || !byId("view-spectrum").checkVisibility()) return;
    if (spectraResult !== state.result) {
      spectraResult = state.result;
      const reply = await engine.latest("spectrum", "spectrum").catch(unlessDropped);
      if (spectraResult !== state.result) return;
      if (!reply) {
        spectraResult = null;
        return;
      }
      spectra = reply;
      const first = reply.ideal ?? reply.pulses;
      const isEmpty = !first?.periodic;
      split.hidden = !first;
      // The filtered acceleration needs a sensor in the scenario.
      const select = /** @type {HTMLSelectElement} */ (byId("spectrum-quantity"));
      const filtered = select.options[select.options.length - 1];
      filtered.hidden = !first?.acceleration_filtered;
      if (filtered.hidden && filtered.selected) select.value = "acceleration";
      dispatch({ type: "empty", view: "spectrum", isEmpty });
      // Removes the value of the previous run, because an empty view is not redrawn.
      if (isEmpty) setText(byId("thd"), "");
      setText(note, reply.note);
    }
    if (!spectra || spectra === drawn || !split.checkVisibility()) return;
    const loaded = await load().catch(() => null);
    if (!loaded) return setText(note, "The spectrum could not be loaded. Check the network, then fold and unfold it.");
    drawn = spectra;
    await loaded.setSpectra(spectra);
  }

  /** Loads the view with its keys. */
  async function load() {
    const { createSpectrumView } = await import("./spectrum.js");
    view ??= createSpectrumView({ dispatch, now });
    return view;
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    view?.render(state, before);
    if (before?.result !== state.result) return refresh(state);
    return undefined;
  }
  return { render, load };
}
