/** The pane of the spectrum; loads spectrum.js on demand. */
import { byId, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createSpectrum({ engine, dispatch, now }) {
  const split = byId("spectrum-split");
  const note = byId("spectrum-note");
  /** @type {import("../../state/types.js").Spectra | null} */
  let spectra = null;
  /** What the view has drawn. @type {import("../../state/types.js").Spectra | null} */
  let drawn = null;
  /** The result that it is of. @type {State["result"]} */
  let about = null;
  /** @type {ReturnType<typeof import("./spectrum.js").createSpectrumView> | null} */
  let view = null;
  const watcher = new ResizeObserver(() => void refresh(now()));
  for (const node of [byId("view-spectrum"), split]) watcher.observe(node);

  /** @param {State} state */
  async function refresh(state) {
    if (!state.result || !byId("view-spectrum").checkVisibility()) return;
    if (about !== state.result) {
      about = state.result;
      const reply = await engine.latest("spectrum", "spectrum").catch(unlessDropped);
      if (about !== state.result) return;
      if (!reply) {
        about = null;
        return;
      }
      spectra = reply;
      const some = reply.ideal ?? reply.pulses;
      const bare = !some?.periodic;
      split.hidden = !some;
      // What a sensor lets through is there where there is one.
      const select = /** @type {HTMLSelectElement} */ (byId("spectrum-quantity"));
      const filtered = select.options[select.options.length - 1];
      filtered.hidden = !some?.acceleration_filtered;
      if (filtered.hidden && filtered.selected) select.value = "acceleration";
      dispatch({ type: "bare", view: "spectrum", bare });
      // Until the view has drawn it, and where there is no room to, the figure before is not this run's.
      if (bare) say(byId("thd"), "");
      say(note, reply.note);
    }
    if (!spectra || spectra === drawn || !split.checkVisibility()) return;
    const loaded = await load().catch(() => null);
    if (!loaded) return say(note, "The spectrum could not be loaded. Check the network, then fold and unfold it.");
    drawn = spectra;
    await loaded.take(spectra);
  }

  /** What draws it, with its keys. */
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
