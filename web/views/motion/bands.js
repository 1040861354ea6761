/** Curves, unit, color and range of the three motion charts. */

import { shown } from "../../state/time_window.js";
import { color, GUTTER } from "../../time/plot.js";
import { lookOf, scaleOf, unitFor, unitOf } from "./axis_units.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").MotionColumns} MotionColumns */
/** @typedef {{min: Float64Array, max: Float64Array}} Columns */
/** @typedef {"position" | "speed" | "acceleration"} Quantity */
/** @typedef {{x: Float64Array, y: Float64Array}} Line */
/** @typedef {{name: string, ink: string, opacity: number, width: number, dash: number, x?: Float64Array, line?: Line} & Columns} Band  Columns, and the exact line, if any. */
/** @typedef {import("../../state/types.js").Outline} Outline */
/** @typedef {{columns: MotionColumns, others: [axis: number, outline: Outline][], baseline: MotionColumns | null, difference: Columns | null}} MotionData  The selected axis, outlines of the other ones, the baseline, and the difference of their positions if it is visible. */
/** @typedef {{low: number, high: number, min: number, max: number}} Range */

export const QUANTITIES = /** @type {const} */ (["position", "speed", "acceleration"]);
/** Height of the time labels below the last chart, in CSS pixels. */
export const TIME_PX = 20;

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

/** The curve of an axis that is not selected; none if it has no such quantity. @param {State} state @param {[number, Outline]} other @param {Quantity} quantity @returns {Band[]} */
function outlineBand(state, [axis, outline], quantity) {
  const scale = scaleOf(state, axis);
  const { time_s: x, [quantity]: values } = outline;
  if (scale === null || (quantity === "acceleration" && !outline.has_acceleration)) return [];
  const band = { name: `axis ${axis}`, opacity: 0.9, width: 1.4, ...lookOf(state, axis), x };
  if (values) {
    const y = scaled(values, scale);
    return [{ ...band, min: y, max: y, line: { x, y } }];
  }
  const [min, max] = /** @type {(Float64Array | undefined)[]} */ (
    ["min", "max"].map((end) => /** @type {any} */ (outline)[`${quantity}_${end}`])
  );
  return min && max ? [{ ...band, min: scaled(min, scale), max: scaled(max, scale) }] : [];
}

/** Whether a visible axis has an acceleration. @param {State} state @param {MotionData} data */
export function hasAcceleration(state, { columns, others, baseline }) {
  const isOwn = columns.has_acceleration && !state.hiddenAxes.includes(state.axis);
  return isOwn || Boolean(baseline?.has_acceleration) || others.some(([, outline]) => outline.has_acceleration);
}

/** The bands from back to front. @param {State} state @param {MotionData} data @param {Quantity} quantity @returns {Band[]} */
export function bandsOf(state, { columns, others, baseline, difference }, quantity) {
  if (quantity === "position" && difference)
    return [{ name: "difference", ink: "--actual", opacity: 1, width: 1.6, dash: 0, ...difference }];
  const { scale, baseline: baselineScale } = unitOf(state);
  const isMissing = (/** @type {MotionColumns} */ of) => quantity === "acceleration" && !of.has_acceleration;
  const isHidden = state.hiddenAxes.includes(state.axis) || isMissing(columns);
  const { ideal, actual } = isHidden ? { ideal: null, actual: null } : curves(columns, quantity, scale);
  const other = baseline && !isMissing(baseline) ? curves(baseline, quantity, baselineScale) : null;
  return [
    ...others.flatMap((each) => outlineBand(state, each, quantity)),
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

/** The visible quantities. @param {State} state @param {MotionData} data @returns {readonly Quantity[]} */
export function quantitiesOf(state, data) {
  return hasAcceleration(state, data) ? QUANTITIES : QUANTITIES.slice(0, 2);
}

/** The chart of a quantity. @param {State} state @param {MotionData} data @param {Quantity} quantity */
export function chartOf(state, data, quantity) {
  const bands = bandsOf(state, data, quantity);
  const range = rangeOf(bands, quantity !== "position" || data.difference !== null);
  const { start, end } = shown(state);
  const clock = state.result?.summary.clock_hz ?? 1;
  const label_px = quantity === quantitiesOf(state, data).at(-1) ? TIME_PX : 0;
  return {
    bands,
    /** Number of curves of other axes, which are the first series. */
    others: bands.filter(({ name }) => name.startsWith("axis")).length,
    range,
    unit: unitFor(state, quantity),
    caption:
      quantity === "position" && data.difference
        ? "actual position minus the baseline’s"
        : quantity + (data.columns.has_ideal || quantity !== "acceleration" ? "" : ", over 8 steps"),
    note: quantity === "speed" && label_px > 0 ? whyNoAcceleration(data.columns) : "",
    chart: {
      x: { min: start / clock, max: end / clock, unit: "s", prefix: true, label_px },
      y: { min: range.min, max: range.max, unit: "", prefix: true, label_px: GUTTER },
      series: bands.map(({ ink, opacity, width, dash, x, line, min, max }) => ({
        color: color(ink),
        opacity,
        width,
        dash,
        x: line?.x ?? x ?? data.columns.x,
        shape: line ? { line: { y: line.y } } : { band: { min, max } },
      })),
    },
  };
}

/** Why there is no chart of the acceleration. @param {MotionColumns} columns */
function whyNoAcceleration({ has_ideal, speed_max, speed_min, actual_speed_max, actual_speed_min }) {
  const speeds = has_ideal ? [speed_min, speed_max] : [actual_speed_min, actual_speed_max];
  return speeds.some((values) => values.some((value) => Math.abs(value) > 0)) ? "stepwise" : "";
}
