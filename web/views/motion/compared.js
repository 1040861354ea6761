/** The comparison with the baseline: a table of figures before and after, and the difference of the positions. */
import { byId, element, fill, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { short, si, time } from "../../state/number.js";
import { selected } from "../../state/queries.js";
import { baselineAxis, unitOf, visibleAxis } from "./axis_units.js";
import { comparedRows, stretched } from "./compared_rows.js";
import { unitPair } from "./request_columns.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{figures: import("../../state/types.js").ComparedFigure[], deviation: import("../../state/types.js").Deviation}} Comparison */

/** Rows of one table; more are in a second one next to it. */
const MAX_ROWS = 6;

/** Whether motions of the same travel are compared at equal duration. */
let isEqual = true;

/** @param {import("../../engine/engine.js").Engine} engine @param {State} state */
export async function showCompared(engine, state) {
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
  const tables = byId("compared-tables");
  if (!found) return fill(tables);
  const { figures } = found;
  const edges = [baseline.summary.controllers[baseline.controller].edges, selected(state)?.edges ?? 0];
  const offersEqual = hasSameTravel(state) && Boolean(figures.find(({ name }) => name === "duration")?.change);
  const show = () => {
    const rows =
      offersEqual && isEqual ? comparedRows(stretched(figures), null, unit) : comparedRows(figures, edges, unit);
    const parts = rows.length > MAX_ROWS ? [rows.slice(0, MAX_ROWS), rows.slice(MAX_ROWS)] : [rows];
    fill(tables, ...(offersEqual ? [equalBox(show)] : []), ...parts.map(table));
  };
  show();
}

/** Whether the motions of run and baseline have the same travel, so that their ramps can be compared. @param {State} state */
function hasSameTravel(state) {
  const [own, other] = [visibleAxis(state), baselineAxis(state).derived];
  return own !== undefined && other !== undefined && own.steps === other.steps;
}

/** The choice of equal duration. @param {() => void} show */
function equalBox(show) {
  const box = element("input", { type: "checkbox" });
  box.checked = isEqual;
  box.addEventListener("change", () => {
    isEqual = box.checked;
    show();
    document.getElementById("compared-tables")?.querySelector("input")?.focus();
  });
  const title = "Stretch this motion in time to the duration of the baseline: speeds and accelerations change with it";
  return element("label", { class: "check", title }, box, "equal duration");
}

/** @param {import("../../state/types.js").Deviation} deviation @param {string} unit */
function positionText({ largest, at_s, rms, common_s }, unit) {
  const noun = Math.abs(largest) === 1 ? unit.replace(/s$/, "") : unit;
  return `Position: maximum difference ${short(Math.abs(largest))} ${noun} at ${time(at_s)}; RMS ${short(rms)} ${unit} over the common time of ${si(common_s, "s")}.`;
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
