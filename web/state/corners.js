/** The corners of the speed curve, where a ramp meets the plateau, and the moves that result when they are dragged. */

/**
 * @typedef {{ramp_s: number, top: number}} Corner  Length of the ramp, and the speed of the plateau or peak, above 0.
 * @typedef {object} Rates  A move in steps, because its fields can have other units.
 * @property {number} steps  Travel, above 0.
 * @property {number} [start]  Start speed of a trapezoid, in steps/s.
 * @property {number} [max]  Its maximum speed.
 * @property {number} [acceleration]  Its acceleration, in steps/s².
 * @property {number} [peak]  Peak of a move with its own duration, if known.
 */

/** Kinds of moves whose duration and ramp are fields. */
const TIMED = ["cosine", "ramps"];

/** The corner of a move; null if its kind has none. @param {{[kind: string]: any}} move @param {Rates} rates @returns {Corner | null} */
export function cornerOf(move, { steps, start = 0, max = 0, acceleration = 0, peak }) {
  const [kind] = Object.keys(move);
  if (!(steps > 0)) return null;
  if (TIMED.includes(kind)) {
    const { duration_s, ramp_s } = move[kind];
    // The area below a ramp of a shape is unknown.
    if (kind === "ramps" && peak === undefined) return null;
    const top = peak ?? steps / (duration_s - ramp_s);
    return top > 0 && Number.isFinite(top) ? { ramp_s, top } : null;
  }
  if (kind !== "trapezoid" || !(acceleration > 0) || !(max > start)) return null;
  // A short move turns before its maximum speed: v² = v0² + 2·a·x in the middle.
  const top = Math.min(max, Math.sqrt(start * start + acceleration * steps));
  return { ramp_s: (top - start) / acceleration, top };
}

/** Duration of a move with this corner. @param {{[kind: string]: any}} move @param {Rates} rates @param {Corner} corner */
export function durationOf(move, { steps, start = 0 }, { ramp_s, top }) {
  const [kind] = Object.keys(move);
  // Both ramps of a trapezoid have the mean speed of its start and its top.
  return TIMED.includes(kind) ? move[kind].duration_s : ramp_s + (steps - ramp_s * start) / top;
}

/** A dragged value with 3 digits; the value before if the drag means no other one. @param {number} before @param {number} value */
export function dragged(before, value) {
  const [old, next] = [before, value].map((each) => Number(each.toPrecision(3)));
  return old === next ? before : next;
}

/**
 * The fields that put the corner at another place: duration and ramp, or maximum speed and acceleration in steps.
 * @param {{[kind: string]: any}} move @param {Rates} rates @param {Corner} to
 * @returns {{duration_s: number, ramp_s: number} | {max: number, acceleration: number} | null}  null if it cannot be there.
 */
export function movedCorner(move, rates, { ramp_s, top }) {
  const [kind] = Object.keys(move);
  const { steps, start = 0 } = rates;
  if (!(top > 0)) return null;
  if (!TIMED.includes(kind))
    return ramp_s > 0 && top > start ? { max: top, acceleration: (top - start) / ramp_s } : null;
  const { duration_s, ramp_s: before } = move[kind];
  // The part of a ramp that its travel lacks at the top speed; 1 for a symmetric ramp, which covers half.
  const lacking = before > 0 && rates.peak ? (duration_s - steps / rates.peak) / before : 1;
  // Both ramps fit into the duration.
  const ramp = Math.min(Math.max(0, ramp_s), steps / top / Math.max(0.1, 2 - lacking));
  return { duration_s: steps / top + lacking * ramp, ramp_s: ramp };
}
