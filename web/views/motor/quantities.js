/** The quantities of the motor view and their charts. */
import { selected } from "../../state/queries.js";
import { color, GUTTER } from "../../time/plot.js";
import { shapeOf } from "../lines.js";

/** @typedef {import("../../state/types.js").State} State */

/** @typedef {{x: Float64Array, min: Float64Array, max: Float64Array}} Band */
/** @typedef {{[name: string]: Band}} Curves  By their names in the core. */
/** @typedef {{name: string, title: string, short?: string, unit: string, lines: {of: string, label: string, ink: string, dash?: number, width?: number}[]}} Quantity */

/** @type {Quantity[]} */
export const QUANTITIES = [
  {
    name: "angle",
    title: "Angle",
    unit: "full steps",
    lines: [
      { of: "command", label: "commanded", ink: "--ideal", dash: 5 },
      { of: "rotor", label: "rotor", ink: "--actual", width: 1.8 },
    ],
  },
  {
    name: "error",
    title: "Following error",
    short: "Error",
    unit: "full steps",
    lines: [{ of: "error", label: "error; red: slip of 4 full steps", ink: "--actual" }],
  },
  { name: "speed", title: "Speed", unit: "full steps/s", lines: [{ of: "speed", label: "rotor", ink: "--actual" }] },
  {
    name: "phases",
    title: "Phase currents",
    short: "Phase",
    unit: "A",
    lines: [
      { of: "phase_a_a", label: "A", ink: "--actual" },
      { of: "phase_b_a", label: "B", ink: "--ideal", dash: 5 },
    ],
  },
  {
    name: "supply",
    title: "Supply current",
    short: "Supply",
    unit: "A",
    lines: [
      { of: "load_a", label: "all motors", ink: "--ideal", dash: 3, width: 1 },
      { of: "sensor_a", label: "at the sensor", ink: "--actual", width: 1.8 },
    ],
  },
  {
    name: "bus",
    title: "Bus voltage",
    short: "Bus",
    unit: "V",
    lines: [{ of: "bus_v", label: "at the drivers", ink: "--actual" }],
  },
  {
    name: "encoder",
    title: "Encoder",
    unit: "codes",
    lines: [{ of: "encoder", label: "4096 per turn", ink: "--actual" }],
  },
];

/** Names of the quantities that are visible by default. */
const DEFAULT = ["angle", "error", "phases", "supply"];

/** The visible quantities in order; the default ones if a link only has unknown names. @param {State} state */
export function visibleQuantities({ quantities }) {
  const among = (/** @type {string[]} */ names) => QUANTITIES.filter(({ name }) => names.includes(name));
  const found = among(quantities ?? []);
  return found.length > 0 ? found : among(DEFAULT);
}

/** The channel of the visible motor: the selected axis, or the last channel. @param {State} state */
export const channelOf = (state) => Math.min(state.axis, (selected(state)?.channels ?? 1) - 1);

/** Minimum distance of two marks, relative to the window. */
const MIN_DISTANCE = 1 / 400;

/** The times of slips of a motor in a window, in s; of slips that are too close together only the first. @param {import("./numbers.js").Report} report @param {number} channel @param {import("../../state/types.js").Span} span @param {number} clock */
export function marksOf({ slips }, channel, { start, end }, clock) {
  let next = start;
  return slips.flatMap(({ channel: of, cycle }) => {
    if (of !== channel || cycle < next || cycle > end) return [];
    next = cycle + (end - start) * MIN_DISTANCE;
    return [cycle / clock];
  });
}

/** Minimum and maximum of the lines of a quantity, and a range around them with a margin. @param {Quantity} quantity @param {Curves} curves */
export function rangeOf({ lines }, curves) {
  let [low, high] = [Infinity, -Infinity];
  for (const { of } of lines) {
    for (const value of curves[of].min) if (value < low) low = value;
    for (const value of curves[of].max) if (value > high) high = value;
  }
  if (low > high) [low, high] = [0, 1];
  const margin = (high - low) * 0.08 || Math.abs(high) * 1e-3 || 1;
  return { low, high, min: low - margin, max: high + margin };
}

/**
 * The chart of a quantity in a window of time.
 * @param {Quantity} quantity @param {Curves} curves @param {{from: number, to: number, marks: number[]}} time  In s; `marks` are the slips, shown in the chart of the following error.
 * @param {boolean} isLast  Whether it has the time labels.
 */
export function chartOf(quantity, curves, { from, to, marks }, isLast) {
  const range = rangeOf(quantity, curves);
  const series = quantity.lines.map(({ of, ink, dash, width }) => {
    const { x } = curves[of];
    const shape = shapeOf(curves[of]);
    return { color: color(ink), opacity: 1, width: width ?? 1.6, dash: dash ?? 0, x, shape };
  });
  const lost = (quantity.name === "error" ? marks : []).map((at) => ({
    color: color("--error"),
    opacity: 0.6,
    width: 1,
    x: [at, at],
    shape: { line: { y: [range.min, range.max] } },
  }));
  return {
    range,
    chart: {
      x: { min: from, max: to, unit: "s", prefix: true, label_px: isLast ? 20 : 0 },
      y: { min: range.min, max: range.max, unit: "", prefix: true, label_px: GUTTER },
      series: [...lost, ...series],
    },
  };
}
