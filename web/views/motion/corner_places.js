/** The corners of the speed curve of the visible axis, and the edits that move them. */
import { convert } from "../../form/values.js";
import { cornerOf, dragged, durationOf } from "../../state/corners.js";
import { get } from "../../state/paths.js";
import { derivedAxis } from "../../state/queries.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{path: string, axis: number, move: any, rates: import("../../state/corners.js").Rates,
 *   corner: import("../../state/corners.js").Corner, start_s: number, end_s: number, sign: number, isLast: boolean}} Place  `isLast`: at the end of the plateau. */
/** @typedef {NonNullable<ReturnType<typeof import("../../state/corners.js").movedCorner>>} Fields */

/** Axes with more moves have no handles. */
const MAX_MOVES = 6;

/** @param {State} state @returns {Place[]} */
export function cornerPlaces(state) {
  const index = state.result?.controller ?? 0;
  const controller = index === 0 ? "source.motion" : `controllers[${index - 1}]`;
  const base = `${controller}.axes[${state.axis}]`;
  const { moves, input_shaper } = get(state.scenario, base) ?? {};
  const groups = get(state.scenario, `${controller}.groups`) ?? [];
  const derived = derivedAxis(state, base);
  if (!state.scenario.source?.motion || !moves || !derived || moves.length > MAX_MOVES) return [];
  // The corners of a shaped curve are rounded, and groups have corners of their own.
  if (input_shaper || groups.length > 0) return [];
  return moves.flatMap((/** @type {any} */ move, /** @type {number} */ at) => {
    const { start_s, duration_s, steps } = derived.moves[at] ?? {};
    const path = `${base}.moves[${at}]`;
    const [kind] = Object.keys(move);
    const inSteps = (/** @type {any} */ quantity) => quantity && Number(convert(quantity, "steps", path, state).steps);
    const rates = {
      steps: Math.abs(steps ?? 0),
      start: inSteps(move[kind].start_speed),
      max: inSteps(move[kind].max_speed),
      acceleration: inSteps(move[kind].max_acceleration),
      peak: moves.length === 1 ? derived.peak_speed_steps_s : undefined,
    };
    const { start_speed, end_speed, deceleration, max_deceleration } = move[kind];
    // The corners of a move between two speeds, or of one that is cut, are elsewhere.
    const hasStart = kind === "trapezoid" ? start_speed === null : start_speed;
    const isBetween = end_speed || deceleration || max_deceleration || hasStart;
    const corner = isBetween || moves[at + 1]?.retarget ? null : cornerOf(move, rates);
    if (!corner) return [];
    const place = {
      path,
      axis: state.axis,
      move,
      rates,
      corner,
      start_s,
      end_s: start_s + duration_s,
      sign: Math.sign(steps),
    };
    // Without a plateau the corners coincide.
    const isSingle = duration_s - 2 * corner.ramp_s < duration_s * 0.02;
    return (isSingle ? [false] : [false, true]).map((isLast) => ({ ...place, isLast }));
  });
}

/** A place after a drag to another top speed. @param {Place} place @param {Fields} fields @param {number} top @returns {Place} */
export function moved(place, fields, top) {
  const [kind] = Object.keys(place.move);
  const move = { [kind]: { ...place.move[kind], ...fields } };
  const corner = cornerOf(move, { ...place.rates, ...fields, peak: top }) ?? place.corner;
  return { ...place, corner, end_s: place.start_s + durationOf(move, place.rates, corner) };
}

/** The edit of the dragged fields, in their units; null if the move is no longer there. Other fields stay as they are now. @param {Place} place @param {Fields} fields @param {State} state */
export function editOf({ path, move }, fields, state) {
  const [kind] = Object.keys(move);
  const now = get(state.scenario, path)?.[kind];
  if (!now) return null;
  const edited = (/** @type {any} */ changed) => ({ path: `${path}.${kind}`, value: { ...now, ...changed } });
  const before = move[kind];
  if ("duration_s" in fields) {
    const duration_s = dragged(before.duration_s, fields.duration_s);
    return edited({ duration_s, ramp_s: Math.min(dragged(before.ramp_s, fields.ramp_s), duration_s / 2) });
  }
  const inUnit = (/** @type {any} */ quantity, /** @type {number} */ steps) => {
    const [unit] = Object.keys(quantity);
    return { [unit]: dragged(quantity[unit], convert({ steps }, unit, path, state)[unit]) };
  };
  return edited({
    max_speed: inUnit(before.max_speed, fields.max),
    max_acceleration: inUnit(before.max_acceleration, fields.acceleration),
  });
}
