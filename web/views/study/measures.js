/**
 * The tab Measures of the study: how good the selected axis is, in numbers. The ideal curve, the steps that are made of it and
 * the pulses as they come are held against each other; where no plan is known, the steps are measured by themselves. What a
 * tab is, says study.js.
 */
import { element, fill, say } from "../../dom.js";
import { Dropped } from "../../engine/engine.js";
import { count, counted, plain, short, si, time } from "../../state/number.js";
import { isStale } from "../../state/queries.js";
import { table } from "./parts.js";

/** @typedef {import("../../state/types.js").State} State */
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

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createMeasures({ engine, panel }) {
  const about = element("p", { class: "study-note" });
  const rest = element("div");
  /** @param {string} title @param {string} note @param {string[]} head */
  const group = (title, note, head) => {
    const list = table(title, ["measure", ...head.map((text) => `#${text}`), "~what it means"]);
    const root = element(
      "section",
      { class: "measures-group" },
      element("h3", {}, title),
      element("p", { class: "study-note" }, note),
      list.root,
    );
    rest.append(root);
    return { root, note: /** @type {Element} */ (root.children[1]), show: list.show };
  };
  const compared = group("Steps and ticks", "", ["ideal → steps", "steps → pulses", "ideal → pulses"]);
  const duration = group("Duration", "", ["value"]);
  const peaks = group("Peaks of the ideal curve", "", ["value"]);
  const thd = group("Distortion", "", ["ideal", "pulses"]);
  const sine = group("Sine by segments", "", ["sine → segments"]);
  const own = group(
    "Steps",
    "No plan is known here, so the steps that the views show are measured by themselves: those of the run, or as they were recorded.",
    ["value"],
  );
  fill(panel, about, rest);

  /** @param {Measures} found */
  function show(found) {
    const { steps, ticks, pulses, step_errors, tick_errors, counts } = found;
    say(
      compared.note,
      `Over ${si(found.length_s, "s", 6)}. Ideal → steps: whole steps at whole cycles, step quantisation. Steps → pulses: what ticks, queue and line add. Sums are over ${counted(pulses.points, "point")}, all else over the curves themselves.`,
    );
    compared.show([
      ...COMPARED.map(([name, of, text]) => [name, of(steps), of(ticks), of(pulses), text]),
      ...ERRORS.map(([name, of, text]) => [name, of(step_errors), of(tick_errors), "", text]),
    ]);
    duration.show([
      ...DURATION.map(([name, key, text]) => [
        name,
        key === "end_error_s" || found.duration[key] === null
          ? seconds(found.duration[key])
          : time(Number(found.duration[key])),
        text,
      ]),
      ["steps due", count(counts.due), "There and back."],
      ["actual pulses", count(counts.actual), "Steps to and fro within one tick cancel and are not made."],
      ["pulses without a step", count(counts.stray), "At a place, or in a direction, in which no step was due."],
    ]);
    peaks.show(PEAKS.map(([name, key, unit, text]) => [name, plain(found.peaks[key], unit), text]));
    sine.root.hidden = !found.sine;
    if (found.sine) {
      const { segments, euclidean, quarter } = found.sine;
      say(
        sine.note,
        `The document's polyline against the exact sine, at the ${counted(quarter.points, "point")} of a quarter; all figures are of these points.`,
      );
      sine.show([
        ["segments", count(segments), "Of a quarter of the period."],
        ["Ev", short(euclidean, 5), "The document's Euclidean distance, in parts of the amplitude."],
        ...COMPARED.map(([name, of, text]) => [name, of(quarter), text]),
      ]);
    }
  }

  /** @param {Spectra | null} spectra @param {number} axis */
  function distortion(spectra, axis) {
    const { ideal = null, pulses = null } = spectra?.axis === axis ? spectra : {};
    thd.root.hidden = !(ideal ?? pulses)?.periodic || !pulses;
    if (!pulses) return;
    // Without a plan only the pulses are known.
    const { order, fundamental_hz } = ideal ?? pulses;
    say(thd.note, `To harmonic ${order} of ${si(fundamental_hz, "Hz", 5)}, in whole periods.`);
    const both = (
      /** @type {"thd_position" | "thd_speed" | "thd_acceleration" | "thd_acceleration_filtered"} */ name,
    ) => [percent(ideal?.[name] ?? null), percent(pulses[name])];
    thd.show([
      [
        "position",
        ...both("thd_position"),
        "Root of the sum of squares of all harmonics but the first, over the first.",
      ],
      ["speed", ...both("thd_speed"), "Harmonic k counts k times."],
      [
        "acceleration",
        ...both("thd_acceleration"),
        "Harmonic k counts k² times: of segments of fixed rate it grows with the order.",
      ],
      ...(pulses.thd_acceleration_filtered === null
        ? []
        : [
            [
              "acceleration filtered",
              ...both("thd_acceleration_filtered"),
              "Behind the sensor's low pass, which the form sets.",
            ],
          ]),
    ]);
  }

  /** @param {State} state */
  async function refresh({ result, axis }) {
    if (!result) return;
    const { controller, summary } = result;
    const [found, spectra, steps] = await Promise.all([
      engine.considerRun("measures", "measures", controller, axis),
      engine.latest("measures-thd", "spectrum"),
      engine.latest("measures-steps", "records_of", axis),
    ])
      .then(async ([found, spectra, run]) => {
        // The slot is the measures' own: a newer question ends this one.
        const figures =
          found === null && (await engine.consider("measures", "step_figures", run, axis, summary.clock_hz));
        return [found, spectra, /** @type {Figures | null} */ (figures || null)];
      })
      .catch((error) => {
        if (!(error instanceof Dropped)) {
          // Too many steps to be measured, say.
          rest.hidden = true;
          say(about, error instanceof Error ? error.message : String(error));
        }
        return [];
      });
    if (found === undefined) return;
    rest.hidden = !found && !steps;
    own.root.hidden = !steps;
    for (const { root } of [compared, duration, peaks, sine]) root.hidden = !found;
    if (steps) {
      say(about, `Channel ${axis}, as the views show it.`);
      own.show(FIGURES.map(([name, of, text]) => [name, of(steps), text]));
    } else if (found) {
      say(about, `Axis ${axis} of the run that the views show.`);
      show(found);
    } else say(about, `Axis ${axis} has no motion, so there is no curve to measure the pulses by.`);
    distortion(spectra, axis);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    panel.classList.toggle("stale", isStale(state));
    return before?.result === state.result && before?.axis === state.axis ? undefined : refresh(state);
  }
  return { render };
}
