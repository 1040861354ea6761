/** The markers 0 to 9 and their table (marker_list.js). */
import { byId, element, fill, setText } from "../../dom.js";
import { shown } from "../../state/time_window.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {import("../../state/types.js").Page & {speak: (text: string) => void}} page */
export function createMarkers({ dispatch, now, speak }) {
  const panel = byId("marker-panel");
  const body = /** @type {Element} */ (panel.querySelector("tbody"));
  /** Fills the table; loaded with the first marker. @type {typeof import("./marker_list.js").listMarkers | null} */
  let list = null;
  byId("marker-set").addEventListener("click", () => {
    const { markers, cursors, hover } = now();
    const digit = markers.indexOf(null);
    if (digit < 0) return speak("All ten markers are set; remove one first.");
    const { start, end } = shown(now());
    dispatch({ type: "marker", digit, cycle: cursors.a ?? hover ?? Math.round((start + end) / 2) });
    speak(`Marker ${digit} is set.`);
  });
  byId("markers-remove").addEventListener("click", () => {
    for (const digit of now().markers.keys()) dispatch({ type: "marker", digit, cycle: null });
    byId("marker-set").focus();
  });

  /** @param {State} state */
  async function paint(state) {
    const count = state.markers.filter((cycle) => cycle !== null).length;
    panel.hidden = count === 0;
    setText(/** @type {Element} */ (panel.querySelector("summary")), `Markers (${count})`);
    if (list || count > 0) await fillTable();
  }

  /** Without `await` once it is loaded, so that the table changes in the same task. */
  async function fillTable() {
    try {
      list ??= (await import("./marker_list.js")).listMarkers;
    } catch {
      const cell = element(
        "td",
        {},
        "The table could not be loaded. Check the network; the next change loads it again.",
      );
      return fill(body, element("tr", {}, cell));
    }
    list(body, { dispatch, now });
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (
      before?.markers !== state.markers ||
      before?.result !== state.result ||
      (before?.cursors !== state.cursors && !panel.hidden)
    )
      paint(state);
  }
  return { render };
}
