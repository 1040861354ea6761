/** The tab Sine: effect of d1 on a sine in segments, best d1 and best vertices (see study.js). */
import { button, element, fill } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { counted, short } from "../../state/number.js";
import { createJob } from "./job.js";
import { choice, field } from "./parts.js";
import { createSegments } from "./segments.js";
import { createSineCharts } from "./sine_charts.js";
import { sensorHarmonics, targetOf } from "./sine_edits.js";
import { createSineNote } from "./sine_note.js";
import {
  bestRow,
  bestRows,
  cellsOf,
  isAtEnd,
  joined,
  MAX_ORDER,
  MIN_ORDER,
  percent,
  pieces,
  progressOf,
  rowOf,
} from "./sine_sweep.js";
import { table } from "./table.js";
import { createVertices } from "./vertices.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./sine_sweep.js").Row} Row */

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createSine({ engine, samples, dispatch, now, panel }) {
  const from = field("d1 from", "", 0.002, { min: 1e-5, max: 1 }, sweep);
  const to = field("to", "", 0.06, { min: 1e-5, max: 1 }, sweep);
  const points = field("points", "", 500, { min: 2, max: 20000, integer: true }, sweep);
  // It is a setting of the experiment: the spectrum uses it, too.
  const order = field("harmonics to", "", MIN_ORDER, { min: MIN_ORDER, max: MAX_ORDER, integer: true }, () =>
    dispatch({ type: "edit", path: "analysis.max_harmonic", value: order.value() }),
  );
  const quantity = choice(
    "THD of",
    { position: "position", speed: "speed", acceleration: "acceleration", filtered: "acceleration, filtered" },
    paint,
  );
  const job = createJob("Sweep", () => (rows ? " The charts show the previous sweep." : ""));
  const list = table("Results by d1", [
    "row",
    "#d1",
    "#segments",
    "#THD position",
    "~#speed",
    "~#acceleration",
    "~#filtered",
    "#Ev",
    "",
  ]);
  const note = createSineNote({ samples, dispatch, now });
  const bestList = table("Best d1 of each number of segments", ["segments", "#best d1", "#THD position", "~#Ev", ""]);
  const vertices = createVertices({ engine, order: order.value, putMove: note.putMove });
  const quarter = createSegments({ engine });
  /** The visible rows; null before the first sweep. @type {import("./sine_sweep.js").Rows | null} */
  let rows = null;
  /** @type {Row | null} */
  let best = null;
  /** The row of the scenario's d1. @type {Row | null} */
  let current = null;
  let currentKey = "";
  /** The selected row. @type {number | null} */
  let selected = null;
  /** Harmonics of the rows. */
  let sweptOrder = 0;
  let isSwept = false;
  let shownOrder = 0;
  /** @type {number | undefined} */
  let sensor;
  const charts = createSineCharts({
    shown: () => ({
      ...{ rows, selected, best, current, sensor, order: sweptOrder || order.value() },
      quantity: /** @type {import("./sine_sweep.js").Quantity} */ (quantity.value()),
    }),
    select(index) {
      if (index === selected) return;
      selected = index;
      mark();
    },
    use() {
      const row = rowOf(rows, selected);
      if (row) note.setDeviation(row.d1);
    },
  });
  fill(
    panel,
    element("div", { class: "study-bar" }, from.root, to.root, points.root, order.root, quantity.root, job.root),
    element(
      "div",
      { class: "study-split" },
      element("div", { class: "study-column" }, charts.root, list.root, note.root),
      element(
        "div",
        { class: "study-column study-side" },
        element("h3", {}, "Best d1 of each number of segments, by position"),
        bestList.root,
        ...vertices.parts,
        quarter.root,
      ),
    ),
  );

  /** @param {Row} row @param {string} name */
  const useButton = (row, name) => button("Use", `Use: ${name}`, () => note.setDeviation(row.d1));

  /** Sweeps the range, and searches it for the best d1. */
  function sweep() {
    const [low, high, number, highest] = [from, to, points, order].map((each) => each.value());
    isSwept = true;
    to.fail(low >= high ? `Out of range; use more than ${low}.` : "");
    if (low >= high) return undefined;
    const work = pieces({ low, high, points: number, order: highest, sensor });
    job.run(
      async (signal, report) => {
        let done = 0;
        const progress = () => {
          const { part, text } = progressOf(++done, number);
          report(part, text);
        };
        report(0, progressOf(0, number).text);
        // The previous rows stay until these arrive.
        const swept = joined(await engine.distribute("sine_rows", work.rows, signal, progress));
        [rows, selected, best, sweptOrder] = [swept, null, null, highest];
        paint();
        return joined(await engine.distribute("sine_best", work.best, signal, progress));
      },
      (found) => {
        const sorted = bestRows(found);
        bestList.show(
          sorted.map((row) => [
            String(row.segments),
            short(row.d1, 6),
            percent(row.position),
            short(row.euclidean, 4),
            useButton(row, `${counted(row.segments, "segment")}, best d1`),
          ]),
        );
        best = bestRow(sorted);
        paint();
      },
    );
    return undefined;
  }

  function paint() {
    charts.paint();
    showRows();
  }

  function mark() {
    charts.mark();
    showRows();
  }

  function showRows() {
    const cells = (
      /** @type {string} */ name,
      /** @type {Row | null} */ row,
      /** @type {string} */ none,
      isUsable = true,
    ) => [...cellsOf(name, row, none), isUsable && row ? useButton(row, name) : ""];
    list.root.classList.toggle("unfiltered", sensor === undefined);
    list.show([
      cells("selected", rowOf(rows, selected), "–"),
      cells("current", current, "none", false),
      cells(
        `best by position${best && rows && isAtEnd(best.d1, rows.d1) ? ": selected the end of the range" : ""}`,
        best,
        "–",
      ),
    ]);
  }

  /** Shows the row of the scenario's d1. @param {State} state */
  async function showCurrent(state) {
    const { axis, move } = targetOf(state);
    if (!axis) return;
    quarter.show(move < 0 ? null : axis);
    const d1 = axis.moves[move]?.sine_segments.max_deviation ?? null;
    const key = `${d1} ${order.value()} ${sensor}`;
    if (key === currentKey) return;
    currentKey = key;
    const args = [d1, d1, 1, order.value(), sensor, 0, 1];
    const found = d1 === null ? null : await engine.compute("sine row", "sine_rows", ...args).catch(unlessDropped);
    if (key !== currentKey) return;
    current = rowOf(found, 0);
    mark();
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const isOtherSensor = targetOf(state).axis !== null && sensorHarmonics(state) !== sensor;
    if (isOtherSensor) sensor = sensorHarmonics(state);
    const highest = Math.max(MIN_ORDER, Number(state.scenario.analysis?.max_harmonic) || 0);
    if (highest !== shownOrder) {
      shownOrder = highest;
      order.set(highest);
      isSwept = false;
    }
    note.render(state);
    if (!isSwept) vertices.find();
    if (!isSwept || isOtherSensor) sweep();
    if (before?.view !== state.view || before?.study !== state.study) paint();
    return showCurrent(state);
  }
  return { render };
}
