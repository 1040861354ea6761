/** The rows of the tab Measures: each number of an axis with its text and its meaning. */
import { count, counted, plain, short, si, time } from "../../state/number.js";

/** @typedef {import("../../state/types.js").Spectra} Spectra */
/**
 * The core's names; times in s.
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

/** The sine document's list. @type {[string, (of: Comparison) => string, string][]} */
const COMPARED = [
  [
    "largest deviation, steps",
    (of) => digits(of.largest_steps),
    "How far the second is ahead of the first where they are farthest apart.",
  ],
  ["at", (of) => si(of.largest_at_s, "s", 5), "When that first is so."],
  [
    "r.m.s. deviation, steps",
    (of) => digits(of.rms_steps),
    "Root of the mean square over the time; 1/√12 = 0.2887 for whole steps at an even rate.",
  ],
  ["area between, steps·s", (of) => digits(of.area_steps_s), "Integral of the deviation's magnitude."],
  [
    "difference of areas, steps·s",
    (of) => digits(of.area_difference_steps_s),
    "Integral of the deviation with its sign: what is ahead and what is behind cancel.",
  ],
  ["sum of squares, steps²", (of) => digits(of.sum_of_squares_steps2), "Of the deviations at the points."],
  [
    "Euclidean distance, steps",
    (of) => digits(of.euclidean_steps),
    "Root of that sum, the sine document's Ev; it grows with the root of the number of points.",
  ],
  [
    "correlation",
    (of) => (of.correlation === null ? "–" : short(of.correlation, 7)),
    "1 where one follows the other in all it does.",
  ],
  ["1 − correlation", (of) => digits(of.uncorrelated), "The same with digits, where the correlation is all nines."],
];
/** @type {[string, (of: Errors) => string, string][]} */
const ERRORS = [
  [
    "largest time error",
    (of) => seconds(of.largest_s),
    "Of a pulse; late is above 0. Whole cycles are off by half a cycle at most.",
  ],
  ["at", (of) => si(of.largest_at_s, "s", 5), "When that pulse comes."],
  [
    "mean time error",
    (of) => seconds(Math.abs(of.mean_s) < 1e-6 * of.rms_s ? 0 : of.mean_s),
    "A delay of all pulses alike.",
  ],
  ["r.m.s. time error", (of) => seconds(of.rms_s), "Root of the mean square of the pulses' time errors."],
  [
    "largest position error, steps",
    (of) => digits(of.largest_steps),
    "How far the ideal motion goes within a pulse's time error.",
  ],
  ["r.m.s. position error, steps", (of) => digits(of.rms_steps), "Root of the mean square of those."],
];
/** @type {[string, string, string, string][]} Name, key, unit, meaning. */
const PEAKS = [
  ["speed", "speed_steps_s", "steps/s", "The highest rate."],
  ["acceleration", "acceleration_steps_s2", "steps/s²", "Where the speed has no jump."],
  ["jerk", "jerk_steps_s3", "steps/s³", "Where the acceleration has no jump."],
  ["jump of speed", "speed_jump_steps_s", "steps/s", "The greatest that the motor has to follow at once."],
  ["jump of acceleration", "acceleration_jump_steps_s2", "steps/s²", "There the jerk has no bound."],
  [
    "start-stop rate",
    "start_stop_steps_s",
    "steps/s",
    "The greatest rate that is taken up from rest, or left for rest, at once; a turn is both.",
  ],
];
/** What steps come to by themselves. @type {[string, (of: Figures) => string, string][]} */
const FIGURES = [
  ["steps", (of) => count(of.steps), "Pulses on STEP."],
  ["of them right", (of) => count(of.right), "With DIR high."],
  ["of them left", (of) => count(of.left), "With DIR low."],
  ["turns", (of) => count(of.turns), "Steps in another direction than the one before."],
  ["position", (of) => count(of.position), "After the last step, from 0 before the first."],
  ["least position", (of) => count(of.least_position), "Farthest to the left."],
  ["greatest position", (of) => count(of.greatest_position), "Farthest to the right."],
  ["first step", (of) => time(of.first_s), "When it comes."],
  ["last step", (of) => time(of.last_s), "When it comes."],
  ["shortest interval", (of) => seconds(of.shortest_interval_s), "From one step to the next."],
  ["at", (of) => (of.shortest_at_s === null ? "–" : si(of.shortest_at_s, "s", 5)), "When it ends."],
  ["longest interval", (of) => seconds(of.longest_interval_s), "A rest is one, too."],
  ["greatest rate", (of) => unit(of.greatest_rate_steps_s, "steps/s"), "1 by the shortest interval."],
  ["mean rate", (of) => unit(of.mean_rate_steps_s, "steps/s"), "From the first step to the last, rests among them."],
  [
    "greatest acceleration",
    (of) => unit(of.greatest_acceleration_steps_s2, "steps/s²"),
    "From each eight steps in one direction to the next eight: from step to step the rounding alone would make it.",
  ],
  [
    "greatest change of interval",
    (of) => percent(of.greatest_interval_change),
    "Between neighbours in one direction: what a timer's jitter makes, and a start.",
  ],
];
/** @type {[string, string, string][]} */
const DURATION = [
  ["requested", "requested_s", "Sum of the times that the moves name; moves that name none count as planned."],
  ["planned", "planned_s", "Time of the ideal curve."],
  ["planned minus requested", "plan_error_s", "The plan's time error."],
  ["last step due", "last_due_s", "From the motion's start."],
  ["last pulse", "last_pulse_s", "From the start of the first tick, or of the segments."],
  ["last pulse late by", "end_error_s", "The run's time error at the end."],
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
  `Over ${si(length_s, "s", 6)}. Ideal → steps: whole steps at whole cycles, step quantisation. Steps → pulses: what ticks, queue and line add. Sums are over ${counted(pulses.points, "point")}, all else over the curves themselves.`;

/** @param {Measures} measures @returns {string[][]} */
export function durationRows({ duration, counts }) {
  return [
    ...DURATION.map(([name, key, text]) => [
      name,
      key === "end_error_s" || duration[key] === null ? seconds(duration[key]) : time(Number(duration[key])),
      text,
    ]),
    ["steps due", count(counts.due), "There and back."],
    ["actual pulses", count(counts.actual), "Steps to and fro within one tick cancel and are not made."],
    ["pulses without a step", count(counts.stray), "At a place, or in a direction, in which no step was due."],
  ];
}

/** @param {Measures} measures @returns {string[][]} */
export const peakRows = ({ peaks }) => PEAKS.map(([name, key, unit, text]) => [name, plain(peaks[key], unit), text]);

/** @param {NonNullable<Measures["sine"]>} sine @returns {string[][]} */
export function sineRows({ segments, euclidean, quarter }) {
  return [
    ["segments", count(segments), "Of a quarter of the period."],
    ["Ev", short(euclidean, 5), "The document's Euclidean distance, in parts of the amplitude."],
    ...COMPARED.map(([name, of, text]) => [name, of(quarter), text]),
  ];
}

/** @param {NonNullable<Measures["sine"]>} sine */
export const sineNote = ({ quarter }) =>
  `The document's polyline against the exact sine, at the ${counted(quarter.points, "point")} of a quarter; all figures are of these points.`;

/** @param {Figures} figures @returns {string[][]} */
export const figureRows = (figures) => FIGURES.map(([name, of, text]) => [name, of(figures), text]);

/**
 * The harmonic distortion of an axis; null where the spectrum is of another axis or of a motion that is not periodic.
 * @param {Spectra | null} spectra @param {number} axis @returns {{note: string, rows: string[][]} | null}
 */
export function distortion(spectra, axis) {
  const { ideal = null, pulses = null } = spectra?.axis === axis ? spectra : {};
  if (!pulses || !(ideal ?? pulses).periodic) return null;
  // Without a plan only the pulses are known.
  const { order, fundamental_hz } = ideal ?? pulses;
  const both = (
    /** @type {"thd_position" | "thd_speed" | "thd_acceleration" | "thd_acceleration_filtered"} */ name,
  ) => [percent(ideal?.[name] ?? null), percent(pulses[name])];
  const rows = [
    ["position", ...both("thd_position"), "Root of the sum of squares of all harmonics but the first, over the first."],
    ["speed", ...both("thd_speed"), "Harmonic k counts k times."],
    [
      "acceleration",
      ...both("thd_acceleration"),
      "Harmonic k counts k² times: of segments of fixed rate it grows with the order.",
    ],
  ];
  if (pulses.thd_acceleration_filtered !== null)
    rows.push([
      "acceleration filtered",
      ...both("thd_acceleration_filtered"),
      "Behind the sensor's low pass, which the form sets.",
    ]);
  return { note: `To harmonic ${order} of ${si(fundamental_hz, "Hz", 5)}, in whole periods.`, rows };
}
