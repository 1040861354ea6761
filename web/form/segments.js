/**
 * Lists of segments as text, one per line. `20 1048576000 -500 right` is count, first interval, change of each interval, and
 * direction; `dwell 65536000` is a pause. Times are in 1/65536 cycles.
 */
import { whole } from "../state/json.js";

const STEPS = /^(\d+)\s+(\d+)(?:\s+([-+−]?\d+))?(?:\s+(left|right))?$/i;
const DWELL = /^dwell\s+(\d+)$/i;

/** @typedef {{steps: {count: number | bigint, interval_q16: number | bigint, add_q16: number | bigint, direction: "positive" | "negative"}} | {dwell: {length_q16: number | bigint}}} Segment */

/** @param {any[]} segments */
export function printSegments(segments) {
  return segments
    .map(({ steps, dwell }) =>
      dwell
        ? `dwell ${dwell.length_q16}`
        : [steps.count, steps.interval_q16, steps.add_q16, steps.direction === "positive" ? "right" : "left"].join(" "),
    )
    .join("\n");
}

/** @param {string} text @returns {{value: Segment[]} | {message: string}} */
export function readSegments(text) {
  const lines = text
    .split("\n")
    .map((line) => line.trim())
    .filter((line) => line !== "");
  const value = [];
  for (const [index, line] of lines.entries()) {
    const segment = readSegment(line);
    if (!segment)
      return {
        message: `Line ${index + 1}: “${line}” is not a segment; use count, interval, change and direction, such as 20 1048576000 -500 right, or dwell 65536000.`,
      };
    value.push(segment);
  }
  return { value };
}

/** @param {string} line @returns {Segment | null} */
function readSegment(line) {
  const [, length] = DWELL.exec(line) ?? [];
  const [, count, interval, add = "0", direction = "right"] = STEPS.exec(line) ?? [];
  if (length === undefined && count === undefined) return null;
  const [first, interval_q16, add_q16] = [length ?? count, interval ?? "0", add.replace("−", "-").replace("+", "")].map(
    whole,
  );
  if (length !== undefined) return { dwell: { length_q16: first } };
  return {
    steps: {
      count: first,
      interval_q16,
      add_q16,
      direction: direction.toLowerCase() === "right" ? "positive" : "negative",
    },
  };
}
