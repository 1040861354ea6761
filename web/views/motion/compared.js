/** The comparison with the baseline: a table of figures before and after, and the difference of the positions. */
import { button, byId, element, fill, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { short, si, time } from "../../state/number.js";
import { selected } from "../../state/queries.js";
import { baselineAxis, unitOf } from "./axis_units.js";
import { comparedRows } from "./compared_rows.js";
import { unitPair } from "./request_columns.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{figures: import("../../state/types.js").ComparedFigure[], deviation: import("../../state/types.js").Deviation}} Comparison */

/** Rows of one table; more are in a second one next to it. */
const MAX_ROWS = 6;

/** @param {{engine: import("../../engine/engine.js").Engine, dispatch: import("../../state/types.js").Page["dispatch"]}} page @param {State} state */
export async function showCompared({ engine, dispatch }, state) {
  const { baseline, result, axis } = state;
  if (!baseline || !result) return;
  const isSame = baseline.revision === result.revision;
  const { index } = baselineAxis(state);
  /** @type {Comparison | null | undefined} */
  const found = isSame
    ? null
    : await engine
        .latest("compared", "baseline_compared", baseline.controller, axis, index, unitPair(state))
        .catch(unlessDropped);
  if (found === undefined) return;
  const { unit } = unitOf(state);
  setText(
    byId("compared-title"),
    found
      ? `Compared with the baseline: ${baseline.title}. ${positionText(found.deviation, unit)}`
      : `Baseline: ${baseline.title}. Change the experiment or choose a preset. Dashed curves show the baseline.`,
  );
  const edges = [baseline.summary.controllers[baseline.controller].edges, selected(state)?.edges ?? 0];
  const rows = found ? comparedRows(found.figures, edges, unit) : [];
  const parts = rows.length > MAX_ROWS ? [rows.slice(0, MAX_ROWS), rows.slice(MAX_ROWS)] : rows.length ? [rows] : [];
  const durations = found?.figures.find(({ name }) => name === "duration");
  const isLonger = Boolean(durations?.change) && Boolean(state.scenario.source?.motion);
  const equal = button(
    "Compare ramps of equal duration",
    "Open the study: every kind of motion in the same time",
    () => {
      dispatch({ type: "study", study: "compare" });
      dispatch({ type: "view", view: "study" });
    },
  );
  fill(byId("compared-tables"), ...parts.map(table), ...(isLonger ? [equal] : []));
}

/** @param {import("../../state/types.js").Deviation} deviation @param {string} unit */
function positionText({ largest, at_s, rms, common_s }, unit) {
  const noun = largest === 1 ? unit.replace(/s$/, "") : unit;
  return `Position: maximum difference ${short(largest)} ${noun} at ${time(at_s)}; RMS ${short(rms)} ${unit} over the common time of ${si(common_s, "s")}.`;
}

/** @param {string[][]} rows */
function table(rows) {
  const cells = (/** @type {string[]} */ [name, ...values]) =>
    element(
      "tr",
      {},
      element("th", { scope: "row" }, name),
      ...values.map((value) => element("td", { class: "number" }, value)),
    );
  const head = ["", "before", "after", "change"].map((text, at) =>
    element("th", { scope: "col", class: at ? "number" : "" }, text),
  );
  return element(
    "table",
    { "aria-label": "Compared with the baseline" },
    element("thead", {}, element("tr", {}, ...head)),
    element("tbody", {}, ...rows.map(cells)),
  );
}
