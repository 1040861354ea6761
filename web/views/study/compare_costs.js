/** Kinds of motion for the same steps in the same time: what each costs, and the move that one becomes. */
import { count, plain, pretty, short, si } from "../../state/number.js";
import { place } from "./place.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./selected_axis.js").SelectedAxis} SelectedAxis */
/** @typedef {{is_met: boolean, least: {needed_mn_m: number, available_mn_m: number, at_s: number} | null}} Torque */
/**
 * @typedef {{name: string, move: {[kind: string]: any}, why: string | null, speed: number, jump: number, acceleration: number, jerk: number,
 *   acceleration_jump: number, time_error_s: number, last_step_s: number, torque: Torque | null, at_speed?: Float64Array,
 *   at_acceleration?: Float64Array}} Cost
 */
/** @typedef {{index: number, move: {[kind: string]: any}, ramp_s: number | undefined, duration_s: number, steps: number, key: string}} Subject  The move that is compared; `key` changes with any edit of it. */
/** @typedef {{text: string, title?: string, mark?: "error" | "jump"}} Cell */

/** Points of each curve. */
export const POINTS = 401;
/** Numbers that differ by less than this ratio are equal: one is the result of a division. */
const TOLERANCE = 1e-6;

/** A number without its unit, which the column head shows. @param {number} value */
const withoutUnit = (value) => plain(value, "").trim();

/** The name of a move's kind in the core's rows. @param {{[kind: string]: any}} move */
export function kindOf(move) {
  const [[kind, { method, shape, interpolation }]] = Object.entries(move);
  return [kind, method, shape, interpolation].filter((part) => part).join(" ");
}

/** Whether two values are equal except for rounding. @param {any} one @param {any} other @returns {boolean} */
export function isSame(one, other) {
  if (typeof one === "number" && typeof other === "number")
    return Math.abs(one - other) <= TOLERANCE * Math.max(Math.abs(one), Math.abs(other));
  if (one === null || typeof one !== "object" || typeof other !== "object") return one === other;
  return Object.keys(one).every((key) => key === "distance" || isSame(one[key], other?.[key]));
}

/** Identifies the axis that a state selects. @param {State} state */
export function axisKey(state) {
  const { controller, path } = place(state);
  return `${controller}:${path}`;
}

/** @param {State} state @param {SelectedAxis} axis @param {number} selected @returns {Subject} */
export function subjectOf(state, { path, controller, axis, moves }, selected) {
  const index = Math.min(selected, moves.length - 1);
  const move = moves[index];
  const { duration_s, ramp_s } = move.cosine ?? move.ramps ?? {};
  const derived = state.derived?.controllers[controller]?.axes[axis]?.moves[index];
  const duration = duration_s ?? derived?.duration_s ?? 0;
  const key = JSON.stringify([path, index, move]);
  return { index, move, ramp_s, duration_s: duration, steps: derived?.steps ?? 0, key };
}

/** The default ramp for a move. @param {Subject} subject */
export const ownRamp = ({ ramp_s, duration_s }) => ramp_s ?? Number(short(duration_s / 4, 4));

/** @param {Subject} subject @param {number} axis */
export function aboutText({ index, steps, duration_s, ramp_s }, axis) {
  if (steps === 0)
    return `Move ${index + 1} of axis ${axis} ends where it starts; select a move with a distance. Compare sines under Sine.`;
  const noRamp = ramp_s === undefined ? "; it has no ramp, so enter one" : "";
  return `Axis ${axis}, move ${index + 1}: ${count(steps)} steps in ${si(duration_s, "s")}${noRamp}.`;
}

/** Why every kind that takes the ramp unchanged refuses it; empty if one accepts it. @param {Cost[]} rows */
export function whyRampRefused(rows) {
  const { why } = rows[0];
  const isRefused =
    why !== null && rows.every(({ move, why: other }) => !("cosine" in move || "ramps" in move) || other === why);
  return isRefused ? pretty(why) : "";
}

/** A kind of motion with the distance of the move that it replaces. @param {{[kind: string]: any}} motion @param {{[kind: string]: any}} before */
export function replacement(motion, before) {
  const [kind, values] = Object.entries(motion)[0];
  const { distance } = /** @type {any} */ (Object.values(before)[0]);
  return { [kind]: "distance" in values ? { ...values, distance: distance ?? values.distance } : values };
}

/** The share of the motor's torque that a motion needs at its minimum margin. @param {Torque} torque @returns {Cell} */
function torqueCell({ is_met, least }) {
  if (!least) return { text: "none" };
  const { needed_mn_m: needed, available_mn_m: available, at_s } = least;
  const share = available > 0 ? `${short((100 * Math.abs(needed)) / available, 3)} %` : "none left";
  const title = `${short(Math.abs(needed), 4)} of ${short(available, 4)} mN·m at ${si(at_s, "s")}`;
  return is_met ? { text: share, title } : { text: `✕ ${share}`, title, mark: "error" };
}

/** @param {number} by @param {string} unit @returns {Cell} */
const jumpCell = (by, unit) => ({
  text: `unbounded, jumps by ${plain(by, unit).replace(" ", "\u00a0")}`,
  mark: "jump",
});

/** The numbers of a row of the table. @param {Cost} cost @param {number} duration_s @returns {Cell[]} */
export function cellsOf(
  { speed, jump, acceleration, jerk, acceleration_jump, torque, time_error_s, last_step_s },
  duration_s,
) {
  const errorShare = short((100 * time_error_s) / duration_s, 3);
  return [
    { text: withoutUnit(speed) },
    jump > 0 ? jumpCell(jump, "steps/s") : { text: withoutUnit(acceleration) },
    jump > 0
      ? { text: "unbounded" }
      : acceleration_jump > 0
        ? jumpCell(acceleration_jump, "steps/s²")
        : { text: withoutUnit(jerk) },
    torque ? torqueCell(torque) : { text: "no motor" },
    { text: Math.abs(time_error_s) <= TOLERANCE * duration_s ? "none" : `${si(time_error_s, "s")} (${errorShare} %)` },
    { text: si(last_step_s, "s", 5) },
  ];
}

/** Whether a motion has a bounded acceleration, and so a chart: not if its speed jumps. @param {Cost} cost */
export const isBounded = ({ jump }) => jump === 0;

/** Range of a chart over some rows. @param {Cost[]} rows @param {"at_speed" | "at_acceleration"} quantity */
export function rangeOf(rows, quantity) {
  const values = rows.flatMap((row) => [...(row[quantity] ?? [])]);
  return { min: Math.min(0, ...values) * 1.05, max: Math.max(0, ...values) * 1.05 || 1 };
}
