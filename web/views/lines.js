/** Legend keys and line shapes of charts. */
import { element } from "../dom.js";

/** A short line in its color. @param {string} ink @param {boolean} dashed */
export function swatch(ink, dashed) {
  const made = element("span", { class: "key" });
  made.style.borderTop = `2px ${dashed ? "dashed" : "solid"} var(${ink})`;
  return made;
}

/** A line if minimum and maximum are equal everywhere, else a band. @param {{min: Float64Array, max: Float64Array}} values */
export function shapeOf({ min, max }) {
  return min.every((value, at) => value === max[at]) ? { line: { y: min } } : { band: { min, max } };
}
