/** Values at both cursors and between them. */
import { byId, element, fill, setText } from "../../dom.js";
import { exactTime, short, si } from "../../state/number.js";
import { unitFor, unitOf } from "./axis_units.js";
import { QUANTITIES } from "./bands.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").Readings} Readings */

/** The definition of the acceleration of steps without a plan (core/inspect/src/motion/step_acceleration.rs). */
const STEP_ACCELERATION =
  "Acceleration of the pulses: rate of the next eight steps minus rate of the eight steps before, divided by the time between their centers. It is undefined without eight steps in one direction; mean and RMS exclude such times.";

/** @param {{engine: import("../../engine/engine.js").Engine}} page */
export function createBetween({ engine }) {
  const root = byId("between");
  let text = "";

  /** @param {State} state */
  async function render(state) {
    const { a, b } = state.cursors;
    if (a === null || b === null || !state.result) {
      root.hidden = true;
      text = "";
      return;
    }
    const reply = /** @type {import("../../state/types.js").Between | null} */ (
      await engine.latest("between", "between", state.axis, a, b)
    );
    if (!reply) return;
    const seconds = (b - a) / state.result.summary.clock_hz;
    const span = `B−A ${exactTime(b - a, state.result.summary.clock_hz)}${seconds === 0 ? "" : ` · 1/|B−A| ${si(1 / Math.abs(seconds), "Hz", 6)}`}`;
    setText(byId("between-span"), `${span} · in ${unitOf(state).unit} and s`);
    fill(
      byId("between-tables"),
      ...[
        ["ideal", reply.ideal],
        ["actual", reply.actual],
      ].flatMap(([name, readings]) =>
        readings
          ? [table(state, /** @type {string} */ (name), /** @type {Readings} */ (readings), reply.ideal !== null)]
          : [],
      ),
    );
    const means = QUANTITIES.flatMap((quantity, index) => {
      const readings = reply.ideal ?? reply.actual;
      return readings.mean[index] === undefined
        ? []
        : [`${quantity} ${short(readings.mean[index] * unitOf(state).scale)} ${unitFor(state, quantity)}`];
    });
    byId("between-tables").append(...(reply.ideal ? [] : [element("p", { class: "note" }, STEP_ACCELERATION)]));
    text = `Between the cursors: ${span}; means of the ${reply.ideal ? "ideal curve" : "pulses"}: ${means.join(", ")}.`;
    root.hidden = false;
  }

  return { render, sentence: () => text };
}

/** @param {State} state @param {string} name @param {Readings} readings @param {boolean} hasPlan */
function table(state, name, { at_a, at_b, mean, rms }, hasPlan) {
  const { scale } = unitOf(state);
  const head = [name, "A", "B", "B−A", "mean", "RMS"].map((text, index) =>
    element("th", { scope: "col", class: index ? "number" : "" }, text),
  );
  const rows = QUANTITIES.map((quantity, index) => {
    const values =
      mean[index] === undefined ? [] : [at_a[index], at_b[index], at_b[index] - at_a[index], mean[index], rms[index]];
    const cells = values.map((value) => element("td", { class: "number" }, short(value * scale, 6)));
    const why = hasPlan ? "acceleration undefined (stepwise speed)" : "undefined (needs eight steps before and after)";
    const undefinedCell = element("td", { class: "none", colspan: "5" }, `– ${why}`);
    return element("tr", {}, element("th", { scope: "row" }, quantity), ...(cells.length ? cells : [undefinedCell]));
  });
  return element(
    "table",
    { "aria-label": `Between the cursors, ${name}` },
    element("thead", {}, element("tr", {}, ...head)),
    element("tbody", {}, ...rows),
  );
}
