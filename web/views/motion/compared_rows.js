/** Rows of the comparison with the baseline: name, before, after, change. */
import { count, plain, short, time } from "../../state/number.js";

/** @typedef {import("../../state/types.js").ComparedFigure} ComparedFigure */

/** How each unit of the core is printed. @type {{[unit in ComparedFigure["unit"]]: (value: number, unit: string) => string}} */
const PRINT = {
  seconds: (value) => time(value),
  length: (value, unit) => `${short(value, 4)} ${unit}`,
  speed: (value, unit) => plain(value, `${unit}/s`),
  acceleration: (value, unit) => plain(value, `${unit}/s²`),
  ratio: (value) => `${short(100 * value, 4)} %`,
  full_steps: (value) => count(value),
};
/** What a figure without a value is called. @type {{[unit: string]: string}} */
const MISSING = { acceleration: "none (speed jumps)", speed: "none" };

/** Relative change below which two figures are equal: one of them is the result of a division. */
const TOLERANCE = 1e-9;

/** The change relative to the value before. @param {number} change @param {number} before */
function relative(change, before) {
  const share = (100 * change) / Math.abs(before);
  return Number.isFinite(share) ? `${share > 0 ? "+" : ""}${short(share, 3)} %` : "";
}

/** @param {ComparedFigure} figure @param {string} unit */
function changeText({ unit: kind, before, change }, unit) {
  if (change === null || before === null) return "–";
  if (change === 0) return "equal";
  const share = relative(change, before);
  // Percentages have no second percentage.
  if (kind === "ratio") return share || "–";
  const absolute = `${change > 0 ? "+" : "−"}${PRINT[kind](Math.abs(change), unit)}`;
  return share ? `${absolute} (${share})` : absolute;
}

/** Exponents of time in the units that change when a motion is stretched in time. @type {{[unit: string]: number}} */
const RATES = { seconds: -1, speed: 1, acceleration: 2 };

/**
 * The figures of the run stretched in time to the duration of the baseline. Figures of the pulses, such as the lag, are
 * left out: another duration needs another run.
 * @param {ComparedFigure[]} figures
 */
export function stretched(figures) {
  const duration = figures.find(({ name }) => name === "duration");
  const factor = (duration?.after ?? 1) / (duration?.before || 1);
  return figures.flatMap((figure) => {
    if (!(figure.unit in RATES)) return [];
    const after = figure.after && figure.after * factor ** RATES[figure.unit];
    const change = after === null || figure.before === null ? null : after - figure.before;
    return [{ ...figure, after, change: Math.abs(change ?? 1) < TOLERANCE * Math.abs(after ?? 0) ? 0 : change }];
  });
}

/** @param {ComparedFigure[]} figures @param {number[] | null} edges  Before and after. @param {string} unit  Of the axis. @returns {string[][]} */
export function comparedRows(figures, edges, unit) {
  const text = (/** @type {ComparedFigure["unit"]} */ kind, /** @type {number | null} */ value) =>
    value === null ? (MISSING[kind] ?? "–") : PRINT[kind](value, unit);
  const [before, after] = edges ?? [0, 0];
  const counts = { name: "edges", unit: /** @type {const} */ ("full_steps"), before, after, change: after - before };
  return [...figures, ...(edges ? [counts] : [])].map((figure) => [
    figure.name,
    text(figure.unit, figure.before),
    text(figure.unit, figure.after),
    changeText(figure, unit),
  ]);
}
