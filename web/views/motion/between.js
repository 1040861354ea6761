/** What lies between the two cursors: the values at both, their difference, mean and root mean square, ideal and actual. */
import { byId, element, fill, say } from "../../dom.js";
import { exactTime, short, si } from "../../state/number.js";
import { QUANTITIES, unitFor, unitOf } from "./bands.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").Readings} Readings */

/** What the acceleration of steps is that no plan is known of (step_acceleration.rs). */
const OF_STEPS =
  "Acceleration of the pulses: the rate of the eight steps from here less that of the eight before, by the time between their middles. Where there are no eight in one direction it is not known; mean and RMS are those of the rest.";

/** @param {{engine: import("../../engine/engine.js").Engine}} page */
export function createBetween({ engine }) {
  const place = byId("between");
  let said = "";

  /** @param {State} state */
  async function render(state) {
    const { a, b } = state.cursors;
    if (a === null || b === null || !state.result) {
      place.hidden = true;
      said = "";
      return;
    }
    const reply = /** @type {import("../../state/types.js").Between | null} */ (
      await engine.latest("between", "between", state.axis, a, b)
    );
    if (!reply) return;
    const seconds = (b - a) / state.result.summary.clock_hz;
    const span = `B−A ${exactTime(b - a, state.result.summary.clock_hz)}${seconds === 0 ? "" : ` · 1/|B−A| ${si(1 / Math.abs(seconds), "Hz", 6)}`}`;
    say(byId("between-span"), `${span} · in ${unitOf(state).unit} and s`);
    fill(
      byId("between-tables"),
      ...[
        ["ideal", reply.ideal],
        ["from pulses", reply.actual],
      ].flatMap(([name, readings]) =>
        readings
          ? [table(state, /** @type {string} */ (name), /** @type {Readings} */ (readings), reply.ideal !== null)]
          : [],
      ),
    );
    const mean = QUANTITIES.flatMap((quantity, index) => {
      const from = reply.ideal ?? reply.actual;
      return from.mean[index] === undefined
        ? []
        : [`${quantity} ${short(from.mean[index] * unitOf(state).scale)} ${unitFor(state, quantity)}`];
    });
    byId("between-tables").append(...(reply.ideal ? [] : [element("p", { class: "note" }, OF_STEPS)]));
    said = `Between the cursors: ${span}; means of ${reply.ideal ? "the ideal curve" : "the pulses"}: ${mean.join(", ")}.`;
    place.hidden = false;
  }

  return { render, sentence: () => said };
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
    const why = hasPlan ? "speed is stepwise, acceleration undefined" : "no eight steps before and after";
    const none = element("td", { class: "none", colspan: "5" }, `– ${why}`);
    return element("tr", {}, element("th", { scope: "row" }, quantity), ...(cells.length ? cells : [none]));
  });
  return element(
    "table",
    { "aria-label": `Between the cursors, ${name}` },
    element("thead", {}, element("tr", {}, ...head)),
    element("tbody", {}, ...rows),
  );
}
