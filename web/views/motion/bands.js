/** Curves, unit, color and range of the three motion charts. */

import { shown } from "../../state/time_window.js";
import { color, GUTTER } from "../../time/plot.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").MotionColumns} MotionColumns */
/** @typedef {{min: Float64Array, max: Float64Array}} Columns */
/** @typedef {"position" | "speed" | "acceleration"} Quantity */
/** @typedef {{x: Float64Array, y: Float64Array}} Line */
/** @typedef {{name: string, ink: string, opacity: number, width: number, dash: number, line?: Line} & Columns} Band  Columns, and the exact line, if any. */
/** @typedef {{columns: MotionColumns, baseline: MotionColumns | null, difference: Columns | null}} MotionData  This run, the baseline, and the difference of their positions if it is visible. */
/** @typedef {{low: number, high: number, min: number, max: number}} Range */

export const QUANTITIES = /** @type {const} */ (["position", "speed", "acceleration"]);
/** Height of the time labels below the last chart, in CSS pixels. */
export const TIME_PX = 20;

/** The derived values of the visible axis. @param {State} state */
function visibleAxis(state) {
  return state.derived?.controllers[state.result?.controller ?? 0]?.axes[state.axis];
}

/** The same axis of the baseline, or its last one. @param {State} state */
export function baselineAxis({ baseline, axis }) {
  const channels = baseline?.summary.controllers[baseline.controller]?.channels ?? 1;
  const index = Math.min(axis, channels - 1);
  return { index, derived: baseline?.derived?.axes[index] };
}

/** @param {State} state @returns {[string, string][]} */
export function unitsOf(state) {
  const axis = visibleAxis(state);
  return [["steps", "steps"], ...(axis?.step_mm ? [["mm", "mm"]] : []), ...(axis?.step_deg ? [["deg", "°"]] : [])].map(
    ([name, text]) => [name, text],
  );
}

/** The selected unit, or steps if the axis does not have it, with the length of a step in this run and in the baseline. @param {State} state */
export function unitOf(state) {
  const axis = visibleAxis(state);
  const { derived } = baselineAxis(state);
  if (state.unit === "mm" && axis?.step_mm)
    return { name: "mm", unit: "mm", scale: axis.step_mm, baseline: derived?.step_mm ?? axis.step_mm };
  if (state.unit === "deg" && axis?.step_deg)
    return { name: "deg", unit: "°", scale: axis.step_deg, baseline: derived?.step_deg ?? axis.step_deg };
  return { name: "steps", unit: "steps", scale: 1, baseline: 1 };
}

/** The unit of a quantity. @param {State} state @param {Quantity} quantity */
export function unitFor(state, quantity) {
  return unitOf(state).unit + { position: "", speed: "/s", acceleration: "/s²" }[quantity];
}

/** @param {Float64Array} values @param {number} scale */
function scaled(values, scale) {
  return scale === 1 ? values : values.map((value) => value * scale);
}

/** The columns of the ideal and the actual curve; null if there are none. @param {MotionColumns} columns @param {Quantity} quantity @param {number} scale */
function curves(columns, quantity, scale) {
  const of = (/** @type {string} */ name) => {
    const [min, max] = ["min", "max"].map((end) => /** @type {any} */ (columns)[`${name}_${end}`]);
    return { min: scaled(min, scale), max: scaled(max, scale) };
  };
  const line = () => ({ x: columns.line_time_s, y: scaled(columns[`line_${quantity}`], scale) });
  return {
    ideal: columns.has_ideal ? { ...of(quantity), line: line() } : null,
    // Pulses have an acceleration only without a plan.
    actual: columns.has_ideal && quantity === "acceleration" ? null : of(`actual_${quantity}`),
  };
}

/** The bands from back to front. @param {State} state @param {MotionData} data @param {Quantity} quantity @returns {Band[]} */
export function bandsOf(state, { columns, baseline, difference }, quantity) {
  if (quantity === "position" && difference)
    return [{ name: "difference", ink: "--actual", opacity: 1, width: 1.6, dash: 0, ...difference }];
  const { scale, baseline: baselineScale } = unitOf(state);
  const { ideal, actual } = curves(columns, quantity, scale);
  const other = baseline ? curves(baseline, quantity, baselineScale) : null;
  return [
    actual && { name: "actual", ink: "--actual", opacity: 0.55, width: 4, dash: 0, ...actual },
    ideal && { name: "ideal", ink: "--ideal", opacity: 1, width: 1.6, dash: 0, ...ideal },
    // The ideal curve of the baseline, or its actual one without a plan.
    other &&
      (other.ideal ?? other.actual) && {
        name: "baseline",
        ink: "--baseline",
        opacity: 1,
        width: 1.8,
        dash: 5,
        .../** @type {Columns} */ (other.ideal ?? other.actual),
      },
  ].filter((band) => band !== null);
}

/** Minimum and maximum value, and a range around them with a margin. @param {Columns[]} bands @param {boolean} hasZero  Whether the range includes 0. @returns {Range} */
function rangeOf(bands, hasZero) {
  let [low, high] = [Infinity, -Infinity];
  for (const { min, max } of bands) {
    for (const value of min) if (value < low) low = value;
    for (const value of max) if (value > high) high = value;
  }
  if (low > high) [low, high] = [0, 1];
  const [from, to] = hasZero ? [Math.min(0, low), Math.max(0, high)] : [low, high];
  const margin = (to - from) * 0.08 || Math.abs(to) * 1e-3 || 1;
  return { low, high, min: from - margin, max: to + margin };
}

/** The chart of a quantity. @param {State} state @param {MotionData} data @param {Quantity} quantity */
export function chartOf(state, data, quantity) {
  const bands = bandsOf(state, data, quantity);
  const range = rangeOf(bands, quantity !== "position" || data.difference !== null);
  const { start, end } = shown(state);
  const clock = state.result?.summary.clock_hz ?? 1;
  const label_px = quantity === "acceleration" ? TIME_PX : 0;
  return {
    bands,
    range,
    unit: unitFor(state, quantity),
    caption:
      quantity === "position" && data.difference
        ? "actual position minus the baseline’s"
        : quantity + (data.columns.has_ideal || quantity !== "acceleration" ? "" : ", over 8 steps"),
    chart: {
      x: { min: start / clock, max: end / clock, unit: "s", prefix: true, label_px },
      y: { min: range.min, max: range.max, unit: "", prefix: true, label_px: GUTTER },
      series: bands.map(({ ink, opacity, width, dash, line, min, max }) => ({
        color: color(ink),
        opacity,
        width,
        dash,
        x: line?.x ?? data.columns.x,
        shape: line ? { line: { y: line.y } } : { band: { min, max } },
      })),
    },
  };
}

/** Why the chart of the acceleration is empty; empty if it is not. @param {MotionColumns} columns */
export function whyNoAcceleration({
  has_ideal,
  actual_acceleration_min: actual,
  acceleration_min,
  acceleration_max,
  speed_min,
  speed_max,
}) {
  if (!has_ideal)
    return actual?.some(Number.isFinite)
      ? ""
      : "There is no plan for this channel, and the acceleration of these steps is undefined.";
  const isZero = (/** @type {number} */ value) => !(Math.abs(value) > 0);
  if (!acceleration_min.every(isZero) || !acceleration_max.every(isZero)) return "";
  const [low, high] = [Math.min(...speed_min), Math.max(...speed_max)];
  return high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high))
    ? "The speed is stepwise, so the acceleration is undefined."
    : "The speed is constant, so the acceleration is 0.";
}
