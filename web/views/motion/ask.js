/** Asks the engine for a stretch of the motion in columns: this run's, and the kept one's where there is one. */
import { keptAxis, unitOf } from "./bands.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../engine/engine.js").Engine} Engine */

/** What a step is in the chosen unit, here and in the kept run. @param {State} state */
export function unitPair(state) {
  const { scale, kept } = unitOf(state);
  return new Float64Array([scale, kept]);
}

/**
 * @param {Engine} engine
 * @param {State} state
 * @param {import("../../state/types.js").Span} span
 * @param {number} columns
 * @param {string} [slot]  Of questions in one slot only the newest is answered.
 * @returns {Promise<import("./bands.js").Seen | null>}
 */
export async function ask(engine, state, { start, end }, columns, slot = "motion") {
  const clock = state.result?.summary.clock_hz ?? 1;
  const window = [start / clock, end / clock, columns];
  const { reference, axis } = state;
  const of = keptAxis(state).index;
  const [own, kept, apart] = await Promise.all([
    engine.latest(slot, "motion", axis, ...window),
    reference && engine.latest(`${slot} kept`, "baseline_motion", reference.controller, of, ...window),
    reference && state.difference
      ? engine.latest(
          `${slot} apart`,
          "baseline_difference",
          reference.controller,
          axis,
          of,
          unitPair(state),
          new Float64Array(window.slice(0, 2)),
          columns,
        )
      : null,
  ]);
  return own && { columns: own, kept, apart };
}
