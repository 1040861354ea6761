/** The markers 0 to 9: a button that sets one, and a table of what lies between them, which goes with the last. */
import { button, byId, element, fill } from "../../dom.js";
import { count, time } from "../../state/number.js";
import { shown } from "../../state/state.js";
import { goToMarker } from "../../time/timeline.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {import("../../state/types.js").Page & {speak: (text: string) => void}} page */
export function createMarkers({ dispatch, now, speak }) {
  const panel = byId("marker-panel");
  const body = /** @type {Element} */ (panel.querySelector("tbody"));
  byId("marker-set").addEventListener("click", () => {
    const { markers, cursors, hover } = now();
    const free = markers.indexOf(null);
    if (free < 0) return speak("All ten markers are set; remove one first.");
    const { start, end } = shown(now());
    dispatch({ type: "marker", digit: free, cycle: cursors.a ?? hover ?? Math.round((start + end) / 2) });
    speak(`Marker ${free} is set.`);
  });
  byId("markers-remove").addEventListener("click", () => {
    for (const digit of now().markers.keys()) dispatch({ type: "marker", digit, cycle: null });
    byId("marker-set").focus();
  });

  /** @param {State} state */
  function paint(state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    const { a } = state.cursors;
    const set = state.markers
      .flatMap((cycle, digit) => (cycle === null ? [] : [{ digit, cycle }]))
      .sort((one, other) => one.cycle - other.cycle);
    panel.hidden = set.length === 0;
    /** @type {Element} */ (panel.querySelector("summary")).textContent = `Markers (${set.length})`;
    const apart = (/** @type {number | undefined | null} */ from, /** @type {number} */ to) =>
      from === null || from === undefined ? "–" : time((to - from) / clock);
    fill(
      body,
      ...set.map(({ digit, cycle }, index) =>
        element(
          "tr",
          {},
          element(
            "td",
            {},
            button(String(digit), `Show marker ${digit}`, () => goToMarker({ dispatch, now }, digit)),
          ),
          ...[time(cycle / clock), count(cycle), apart(set[index - 1]?.cycle, cycle), apart(a, cycle)].map((text) =>
            element("td", { class: "number" }, text),
          ),
          element(
            "td",
            {},
            button("×", `Remove marker ${digit}`, () => remove(digit)),
          ),
        ),
      ),
    );
  }

  /** @param {number} digit */
  function remove(digit) {
    dispatch({ type: "marker", digit, cycle: null });
    const next = body.querySelector("button");
    (next ?? byId("marker-set")).focus();
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
