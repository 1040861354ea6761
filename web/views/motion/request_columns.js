/** Requests a part of the motion in columns, and that of the baseline. */
import { baselineAxis, unitOf } from "./bands.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../engine/engine.js").Engine} Engine */

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
 * @returns {Promise<import("./bands.js").MotionData | null>}
 */
export async function requestColumns(engine, state, { start, end }, columns, slot = "motion") {
  const clock = state.result?.summary.clock_hz ?? 1;
  const window = [start / clock, end / clock, columns];
  const { baseline, axis } = state;
  const of = baselineAxis(state).index;
  const [own, other, difference] = await Promise.all([
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
  ]);
  return own && { columns: own, baseline: other, difference };
}
