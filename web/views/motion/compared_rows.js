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
const MISSING = { acceleration: "undefined", speed: "none" };

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

/** @param {ComparedFigure[]} figures @param {number[]} edges  Before and after. @param {string} unit  Of the axis. @returns {string[][]} */
export function comparedRows(figures, [before, after], unit) {
  const text = (/** @type {ComparedFigure["unit"]} */ kind, /** @type {number | null} */ value) =>
    value === null ? (MISSING[kind] ?? "–") : PRINT[kind](value, unit);
  const edges = { name: "edges", unit: /** @type {const} */ ("full_steps"), before, after, change: after - before };
  return [...figures, edges].map((figure) => [
    figure.name,
    text(figure.unit, figure.before),
    text(figure.unit, figure.after),
    changeText(figure, unit),
  ]);
}
