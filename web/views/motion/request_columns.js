/** Requests a part of the motion in columns, and that of the baseline. */
import { baselineAxis, unitOf } from "./bands.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../engine/engine.js").Engine} Engine */

/** What a step is in the selected unit, here and in the baseline. @param {State} state */
export function unitPair(state) {
  const { scale, baseline } = unitOf(state);
  return new Float64Array([scale, baseline]);
}

/**
 * @param {Engine} engine
 * @param {State} state
 * @param {import("../../state/types.js").Span} span
 * @param {number} columns
 * @param {string} [slot]  Of questions in one slot only the newest is answered.
 * @returns {Promise<import("./bands.js").Seen | null>}
 */
export async function requestColumns(engine, state, { start, end }, columns, slot = "motion") {
  const clock = state.result?.summary.clock_hz ?? 1;
  const window = [start / clock, end / clock, columns];
  const { baseline, axis } = state;
  const of = baselineAxis(state).index;
  const [own, other, apart] = await Promise.all([
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
  return own && { columns: own, baseline: other, apart };
}
