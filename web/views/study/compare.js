/** The tab Compare: the selected move as every kind of motion (see study.js). */
import { button, element, fill, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { pretty } from "../../state/number.js";
import { createCompareCharts } from "./compare_charts.js";
import {
  aboutText,
  axisKey,
  cellsOf,
  isSame,
  kindOf,
  ownRamp,
  POINTS,
  replacement,
  subjectOf,
  whyRampRefused,
} from "./compare_costs.js";
import { field } from "./parts.js";
import { isAnother, selectedAxis } from "./selected_axis.js";
import { focusRow, table } from "./table.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./compare_costs.js").Cost} Cost */

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createCompare({ engine, dispatch, now, panel }) {
  const about = element("span", { class: "study-note" });
  const moves = element("select");
  const moveLabel = element("label", {}, "move ", moves);
  const ramp = field("Ramp", "s", 0.2, { min: 0, max: 1e6 }, () => {
    followsRamp = false;
    refresh(now());
  });
  const charts = createCompareCharts(
    () => ({ rows, duration_s }),
    () => list.body.querySelectorAll("canvas"),
  );
  const list = table("Kinds of motion", [
    "motion",
    "#maximum rate, steps/s",
    "#maximum acceleration, steps/s²",
    "#maximum jerk, steps/s³",
    "#torque",
    "#time error",
    "#last step",
    "",
  ]);
  const all = element(
    "div",
    { class: "study-compare" },
    element("p", { class: "study-caption" }, "Speed, steps/s, over time"),
    element("div", { class: "study-speeds" }, charts.speeds),
    list.root,
    element("p", { class: "study-caption" }, "Acceleration, steps/s², over time"),
    charts.accelerations,
  );
  fill(panel, element("div", { class: "study-bar" }, moveLabel, ramp.root, about), all);
  moves.addEventListener("change", () => {
    followsRamp = true;
    refresh(now());
  });
  /** @type {Cost[]} */
  let rows = [];
  let duration_s = 0;
  /** Whether the ramp is the move's own. */
  let followsRamp = true;
  let move = 0;
  let subjectKey = "";
  /** Number of the last request; replies to older ones are dropped. */
  let request = 0;
  /** Axis and move of the rows: the only move that their buttons replace. */
  let rowsOf = "";

  /** @param {State} state */
  async function refresh(state) {
    const axis = selectedAxis(state);
    const number = ++request;
    // Rows of another axis must not be put into this one.
    if (!rowsOf.startsWith(`${axisKey(state)} `)) clear();
    disableButtons();
    if (axis === null) return undefined;
    panel.classList.toggle("stale", axis === "");
    if (axis === "") return undefined;
    ramp.root.hidden = all.hidden = typeof axis === "string";
    if (typeof axis === "string") {
      moveLabel.hidden = true;
      return setText(about, axis);
    }
    const subject = subjectOf(state, axis, Number(moves.value || 0));
    move = subject.index;
    duration_s = subject.duration_s;
    showMoves(axis.moves.length);
    // Another move, or an edit of this one, brings its own ramp back.
    if (subject.key !== subjectKey) followsRamp = true;
    subjectKey = subject.key;
    if (followsRamp) ramp.set(ownRamp(subject));
    all.hidden = subject.steps === 0;
    setText(about, aboutText(subject, axis.axis));
    if (subject.steps === 0) return undefined;
    const args = [axis.json, axis.controller, axis.axis, move, ramp.value(), POINTS];
    const costs = await engine.compute("compare", "compare", ...args).catch(unlessDropped);
    if (!costs || number !== request) return undefined;
    rows = costs;
    rowsOf = `${axisKey(state)} ${move}`;
    // A ramp that no kind accepts is an error of its field, not of every row.
    const why = whyRampRefused(rows);
    ramp.fail(why);
    all.hidden = why !== "";
    if (why) return clear();
    show(subject.move);
    return charts.paint();
  }

  /** @param {number} number */
  function showMoves(number) {
    if (moves.options.length !== number)
      fill(moves, ...Array.from({ length: number }, (_, at) => element("option", { value: String(at) }, `${at + 1}`)));
    moves.value = String(move);
    moveLabel.hidden = number < 2;
  }

  function clear() {
    [rows, rowsOf] = [[], ""];
    list.show([]);
    charts.clear();
  }

  /** Until the reply arrives no row can be used; the focus stays in its row. */
  function disableButtons() {
    for (const press of list.body.querySelectorAll("button")) {
      if (press === document.activeElement) focusRow(press.closest("tr"));
      press.disabled = true;
    }
  }

  /** Replaces the move by a motion of the table. @param {{[kind: string]: any}} motion */
  function replaceMove(motion) {
    const axis = selectedAxis(now());
    if (!axis || typeof axis === "string" || rowsOf !== `${axisKey(now())} ${move}` || !axis.moves[move]) return;
    const value = replacement(motion, axis.moves[move]);
    // The ramp of the comparison stays.
    subjectKey = JSON.stringify([axis.path, move, value]);
    followsRamp = false;
    dispatch({ type: "edit", path: `${axis.path}.moves[${move}]`, value });
  }

  /** @param {{[kind: string]: any}} inUse */
  function show(inUse) {
    list.show(
      rows.map((cost) => {
        const key = element("canvas", { class: "study-key", "aria-hidden": "true" });
        const name = element("span", { class: "study-name" }, key, cost.name);
        if (cost.why !== null) return [name, pretty(cost.why), "", "", "", "", "", ""];
        const cells = cellsOf(cost, duration_s).map(({ text, title, mark }) =>
          title || mark ? element("span", { ...(title ? { title } : {}), class: mark ?? "" }, text) : text,
        );
        const press = isSame(cost.move, inUse)
          ? "in use"
          : button("Use", `Use: ${cost.name}`, () => replaceMove(cost.move));
        return [name, ...cells, press];
      }),
    );
    for (const [at, { why, move }] of rows.entries()) {
      const row = /** @type {HTMLTableRowElement} */ (list.body.children[at]);
      row.classList.toggle("chosen", kindOf(move) === kindOf(inUse));
      if (why === null) continue;
      while (row.cells.length > 2) row.deleteCell(-1);
      row.cells[1].colSpan = 7;
      row.cells[1].className = "why";
    }
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    return isAnother(state, before) ? refresh(state) : undefined;
  }
  return { render };
}
