/** The table of edges, one page at a time. */
import { byId, element, fill, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, time } from "../../state/number.js";
import { shown } from "../../state/time_window.js";
import { nameOf } from "./rows.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").EdgeRow} EdgeRow */

/** Minimum edges of a page; it also has all other edges of the last cycle. */
const PAGE_EDGES = 50;

/** @param {{engine: import("../../engine/engine.js").Engine, now: () => State}} page */
export function createEdges({ engine, now }) {
  const panel = /** @type {HTMLDetailsElement} */ (byId("edge-panel"));
  const which = /** @type {HTMLSelectElement} */ (byId("edges-of"));
  const [earlier, later] = /** @type {HTMLButtonElement[]} */ ([byId("edges-earlier"), byId("edges-later")]);
  /** @type {EdgeRow[]} */
  let rows = [];

  const heads = ["time", "cycle", "signal", "level"].map((text, column) =>
    element("th", { scope: "col", ...(column < 2 ? { class: "number" } : {}) }, text),
  );
  fill(/** @type {Element} */ (panel.querySelector("thead")), element("tr", {}, ...heads));
  which.addEventListener("change", showFromWindow);
  byId("edges-from").addEventListener("click", showFromWindow);
  earlier.addEventListener("click", () => showPage(rows[0]?.cycle ?? 0, false));
  later.addEventListener("click", () => showPage(rows[rows.length - 1]?.cycle ?? -1, true));

  /** Shows the edges from the start of the visible time. */
  function showFromWindow() {
    return showPage(shown(now()).start - 1, true);
  }

  /** Shows the edges after or before a cycle. @param {number} cycle @param {boolean} forward */
  async function showPage(cycle, forward) {
    const bit = which.value === "row" ? now().row : undefined;
    const reply = await engine.latest("edges", "edges", bit, cycle, forward, PAGE_EDGES).catch(unlessDropped);
    if (!reply) return;
    ({ rows } = reply);
    // `more` only counts edges in the direction of the search.
    earlier.disabled = forward ? cycle < 0 : !reply.more;
    later.disabled = forward && !reply.more;
    paint(now());
  }

  /** @param {State} state */
  function paint(state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    setText(
      byId("edges-count"),
      rows.length === 0
        ? "No edge there."
        : `${rows.length} edges, from ${time(rows[0].cycle / clock)} to ${time(rows[rows.length - 1].cycle / clock)}`,
    );
    fill(
      /** @type {Element} */ (panel.querySelector("tbody")),
      ...rows.map(({ cycle, bit, high }) =>
        element(
          "tr",
          {},
          ...[time(cycle / clock), count(cycle)].map((text) => element("td", { class: "number" }, text)),
          element("td", {}, nameOf(state, bit)),
          element("td", {}, high ? "high" : "low"),
        ),
      ),
    );
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (!panel.open) return;
    if (before?.result !== state.result || (before?.row !== state.row && which.value === "row")) showFromWindow();
  }
  return { render, showFromWindow };
}
