/** The rows of the tab Measures: numbers of an axis with their meaning. */
import { count, counted, plain, short, si, time } from "../../state/number.js";

/** @typedef {import("../../state/types.js").Spectra} Spectra */
/**
 * Names of the core; times in s.
 * @typedef {{largest_steps: number, largest_at_s: number, rms_steps: number, area_steps_s: number, area_difference_steps_s: number,
 *   points: number, sum_of_squares_steps2: number, euclidean_steps: number, correlation: number | null, uncorrelated: number | null}} Comparison
 * @typedef {{pulses: number, largest_s: number, largest_at_s: number, mean_s: number, rms_s: number, largest_steps: number, rms_steps: number}} Errors
 * @typedef {{length_s: number, steps: Comparison, ticks: Comparison, pulses: Comparison, step_errors: Errors, tick_errors: Errors,
 *   counts: {due: number, actual: number, stray: number}, peaks: {[name: string]: number}, duration: {[name: string]: number | null},
 *   sine: {segments: number, euclidean: number, quarter: Comparison} | null}} Measures
 */

/** The core's `StepFigures`. @typedef {{steps: number, right: number, left: number, turns: number, position: number, least_position: number,
 *   greatest_position: number, first_s: number, last_s: number, shortest_interval_s: number | null, shortest_at_s: number | null,
 *   longest_interval_s: number | null, greatest_rate_steps_s: number | null, mean_rate_steps_s: number | null,
 *   greatest_acceleration_steps_s2: number | null, greatest_interval_change: number | null}} Figures */

/** @param {number | null} value */
const digits = (value) => (value === null ? "–" : short(value, 4));
/** @param {number | null} value */
const seconds = (value) => (value === null ? "–" : si(value, "s"));
/** @param {number | null} value */
const percent = (value) => (value === null ? "–" : `${short(100 * value, 5)} %`);
/** @param {number | null} value @param {string} name */
const unit = (value, name) => (value === null ? "–" : plain(value, name));

/** The measures of SWorldJournal 2022. @type {[string, (of: Comparison) => string, string][]} */
const COMPARED = [
  [
    "maximum deviation, steps",
    (of) => digits(of.largest_steps),
    "Maximum difference between both curves; positive if the second is ahead.",
  ],
  ["at", (of) => si(of.largest_at_s, "s", 5), "Time of the maximum."],
  [
    "RMS deviation, steps",
    (of) => digits(of.rms_steps),
    "Root mean square over time; 1/√12 = 0.2887 for whole steps at a constant rate.",
  ],
  ["area between, steps·s", (of) => digits(of.area_steps_s), "Integral of the absolute deviation."],
  ["difference of areas, steps·s", (of) => digits(of.area_difference_steps_s), "Integral of the signed deviation."],
  ["sum of squares, steps²", (of) => digits(of.sum_of_squares_steps2), "Sum of squared deviations at the points."],
  [
    "Euclidean distance, steps",
    (of) => digits(of.euclidean_steps),
    "Square root of that sum, Ev in SWorldJournal 2022. It grows with the square root of the number of points.",
  ],
  [
    "correlation",
    (of) => (of.correlation === null ? "–" : short(of.correlation, 7)),
    "1 if both curves are proportional.",
  ],
  ["1 − correlation", (of) => digits(of.uncorrelated), "The distance from 1, with more digits."],
];
/** @type {[string, (of: Errors) => string, string][]} */
const ERRORS = [
  [
    "maximum time error",
    (of) => seconds(of.largest_s),
    "Maximum time error of a pulse; positive if late. Rounding to cycles adds at most half a cycle.",
  ],
  ["at", (of) => si(of.largest_at_s, "s", 5), "Time of that pulse."],
  [
    "mean time error",
    (of) => seconds(Math.abs(of.mean_s) < 1e-6 * of.rms_s ? 0 : of.mean_s),
    "Mean delay of all pulses.",
  ],
  ["RMS time error", (of) => seconds(of.rms_s), "Root mean square of the time errors."],
  [
    "maximum position error, steps",
    (of) => digits(of.largest_steps),
    "Travel of the ideal motion during the time error of a pulse.",
  ],
  ["RMS position error, steps", (of) => digits(of.rms_steps), "Root mean square of these errors."],
];
/** @type {[string, string, string, string][]} Name, key, unit, meaning. */
const PEAKS = [
  ["speed", "speed_steps_s", "steps/s", "Maximum rate."],
  ["acceleration", "acceleration_steps_s2", "steps/s²", "Without jumps of speed."],
  ["jerk", "jerk_steps_s3", "steps/s³", "Without jumps of acceleration."],
  ["jump of speed", "speed_jump_steps_s", "steps/s", "Maximum step of speed without a ramp."],
  ["jump of acceleration", "acceleration_jump_steps_s2", "steps/s²", "The jerk is infinite there."],
  [
    "start-stop rate",
    "start_stop_steps_s",
    "steps/s",
    "Maximum rate at which the motion starts or stops without a ramp. A reversal does both.",
  ],
];
/** Figures of steps without a plan. @type {[string, (of: Figures) => string, string][]} */
const FIGURES = [
  ["steps", (of) => count(of.steps), "Pulses on STEP."],
  ["right", (of) => count(of.right), "With DIR high."],
  ["left", (of) => count(of.left), "With DIR low."],
  ["reversals", (of) => count(of.turns), "Steps with another direction than the step before."],
  ["position", (of) => count(of.position), "Final position, relative to the start."],
  ["minimum position", (of) => count(of.least_position), "Leftmost position."],
  ["maximum position", (of) => count(of.greatest_position), "Rightmost position."],
  ["first step", (of) => time(of.first_s), "Its time."],
  ["last step", (of) => time(of.last_s), "Its time."],
  ["shortest interval", (of) => seconds(of.shortest_interval_s), "Shortest time between two steps."],
  ["at", (of) => (of.shortest_at_s === null ? "–" : si(of.shortest_at_s, "s", 5)), "Time of its end."],
  ["longest interval", (of) => seconds(of.longest_interval_s), "Includes pauses."],
  ["maximum rate", (of) => unit(of.greatest_rate_steps_s, "steps/s"), "Reciprocal of the shortest interval."],
  ["mean rate", (of) => unit(of.mean_rate_steps_s, "steps/s"), "From the first to the last step, including pauses."],
  [
    "maximum acceleration",
    (of) => unit(of.greatest_acceleration_steps_s2, "steps/s²"),
    "Between groups of eight steps, because rounding dominates between single steps.",
  ],
  [
    "maximum change of interval",
    (of) => percent(of.greatest_interval_change),
    "Between neighboring intervals in one direction, for example because of timer jitter or a start.",
  ],
];
/** @type {[string, string, string][]} */
const DURATION = [
  ["requested", "requested_s", "Sum of the given durations; other moves count as planned."],
  ["planned", "planned_s", "Duration of the ideal curve."],
  ["planned minus requested", "plan_error_s", "Time error of the plan."],
  ["last step due", "last_due_s", "From the start of the motion."],
  ["last pulse", "last_pulse_s", "From the start of the first tick or the segments."],
  ["delay of the last pulse", "end_error_s", "Time error at the end of the run."],
];

/** @param {Measures} measures @returns {string[][]} */
export function comparedRows({ steps, ticks, pulses, step_errors, tick_errors }) {
  return [
    ...COMPARED.map(([name, of, text]) => [name, of(steps), of(ticks), of(pulses), text]),
    ...ERRORS.map(([name, of, text]) => [name, of(step_errors), of(tick_errors), "", text]),
  ];
}

/** @param {Measures} measures */
export const comparedNote = ({ length_s, pulses }) =>
  `Over ${si(length_s, "s", 6)}. Ideal → steps: rounding to whole steps and cycles. Steps → actual: effect of ticks, queue and line. Sums use ${counted(pulses.points, "point")}; all other figures use the curves.`;

/** @param {Measures} measures @returns {string[][]} */
export function durationRows({ duration, counts }) {
  return [
    ...DURATION.map(([name, key, text]) => [
      name,
      key === "end_error_s" || duration[key] === null ? seconds(duration[key]) : time(Number(duration[key])),
      text,
    ]),
    ["steps due", count(counts.due), "In both directions."],
    ["actual pulses", count(counts.actual), "Opposite steps in one tick cancel."],
    ["pulses without a planned step", count(counts.stray), "No planned step has their position and direction."],
  ];
}

/** @param {Measures} measures @returns {string[][]} */
export const peakRows = ({ peaks }) => PEAKS.map(([name, key, unit, text]) => [name, plain(peaks[key], unit), text]);

/** @param {NonNullable<Measures["sine"]>} sine @returns {string[][]} */
export function sineRows({ segments, euclidean, quarter }) {
  return [
    ["segments", count(segments), "Segments per quarter of the period."],
    ["Ev", short(euclidean, 5), "Euclidean distance of SWorldJournal 2022, relative to the amplitude."],
    ...COMPARED.map(([name, of, text]) => [name, of(quarter), text]),
  ];
}

/** @param {NonNullable<Measures["sine"]>} sine */
export const sineNote = ({ quarter }) =>
  `Polyline of SWorldJournal 2022 compared with the exact sine, at ${counted(quarter.points, "point")} of a quarter.`;

/** @param {Figures} figures @returns {string[][]} */
export const figureRows = (figures) => FIGURES.map(([name, of, text]) => [name, of(figures), text]);

/**
 * The harmonic distortion of an axis; null if the spectrum is of another axis or of a motion that is not periodic.
 * @param {Spectra | null} spectra @param {number} axis @returns {{note: string, rows: string[][]} | null}
 */
export function distortion(spectra, axis) {
  const { ideal = null, pulses = null } = spectra?.axis === axis ? spectra : {};
  if (!pulses || !(ideal ?? pulses).periodic) return null;
  // Without a plan there is only the actual curve.
  const { order, fundamental_hz } = ideal ?? pulses;
  const both = (
    /** @type {"thd_position" | "thd_speed" | "thd_acceleration" | "thd_acceleration_filtered"} */ name,
  ) => [percent(ideal?.[name] ?? null), percent(pulses[name])];
  const rows = [
    [
      "position",
      ...both("thd_position"),
      "Square root of the sum of squares of harmonics from 2, divided by the first.",
    ],
    ["speed", ...both("thd_speed"), "Harmonic k is weighted with k."],
    [
      "acceleration",
      ...both("thd_acceleration"),
      "Harmonic k is weighted with k². For segments of constant rate it grows with the order.",
    ],
  ];
  if (pulses.thd_acceleration_filtered !== null)
    rows.push([
      "filtered acceleration",
      ...both("thd_acceleration_filtered"),
      "After the low-pass filter of the sensor.",
    ]);
  return { note: `To harmonic ${order} of ${si(fundamental_hz, "Hz", 5)}, in whole periods.`, rows };
}
