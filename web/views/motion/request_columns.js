/** Requests a part of the motion in columns, and that of the baseline. */

import { selected } from "../../state/queries.js";
import { baselineAxis, otherAxes, unitOf } from "./axis_units.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../engine/engine.js").Engine} Engine */

/** More axes than this have half as many columns, so that they still follow a moving window. */
const MANY = 4;

/** The length of a step in the selected unit, in this run and in the baseline. @param {State} state */
export function unitPair(state) {
  const { scale, baseline } = unitOf(state);
  return new Float64Array([scale, baseline]);
}

/**
 * @param {Engine} engine
 * @param {State} state
 * @param {import("../../state/types.js").Span} span
 * @param {number} columns
 * @param {string} [slot]  Only the newest request of a slot gets a reply.
 * @param {boolean} [all]  Whether the other axes are requested, too.
 * @returns {Promise<import("./bands.js").MotionData | null>}
 */
export async function requestColumns(engine, state, { start, end }, columns, slot = "motion", all = true) {
  const clock = state.result?.summary.clock_hz ?? 1;
  const window = [start / clock, end / clock, columns];
  const { baseline, axis } = state;
  const of = baselineAxis(state).index;
  const axes = all ? otherAxes(state, selected(state)?.channels ?? 1) : [];
  const coarse = axes.length > MANY ? Math.ceil(columns / 2) : columns;
  const [own, other, difference, outlines] = await Promise.all([
    engine.latest(slot, "motion", axis, ...window),
    baseline && engine.latest(`${slot} baseline`, "baseline_motion", baseline.controller, of, ...window),
    baseline && state.difference
      ? engine.latest(
          `${slot} apart`,
          "baseline_difference",
          baseline.controller,
          axis,
          of,
          unitPair(state),
          new Float64Array(window.slice(0, 2)),
          columns,
        )
      : null,
    axes.length ? engine.latest(`${slot} axes`, "outlines", Uint8Array.from(axes), ...window.with(2, coarse)) : [],
  ]);
  const others = axes.map((axis, at) => /** @type {[number, any]} */ ([axis, outlines?.[at] ?? { time_s: [] }]));
  return own && { columns: own, others, baseline: other, difference };
}
