/** The limits of a number in the form, and whether a slider suits it. */
import { get } from "../state/paths.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {{min: number, max: number}} Limits  In the unit of the field; infinite if unknown. */

/** Maximum values of a slider for whole numbers, and the maximum length of a range of other numbers. */
const [MAX_VALUES, MAX_LENGTH] = [128, 20];
/** A slider has at least this number of steps. */
const SLIDER_STEPS = 100;

/** The numbers in the text of a range, such as `10^-6 to 86400`. @param {string} range @returns {Partial<Limits>} */
export function limitsIn(range) {
  const numbers = range.split(" to ").map((text) => (text ? Number(text.replace("10^", "1e")) : Number.NaN));
  const [min, max] = numbers;
  return numbers.length === 2 && min < max ? { min, max } : {};
}

/** @param {Field} field @param {string} path @param {import("../state/types.js").Scenario} scenario @returns {Limits} */
export function limitsOf({ key, range = "" }, path, scenario) {
  if (isHalf(range)) {
    const duration = get(scenario, `${path.slice(0, -key.length)}duration_s`);
    return { min: 0, max: duration > 0 ? duration / 2 : Infinity };
  }
  return { min: -Infinity, max: Infinity, ...limitsIn(range) };
}

/** @param {string} range */
const isHalf = (range) => range.startsWith("0 to half of the duration");

/** Whether each value of the range is an ordinary choice. @param {Field} field */
export function hasSlider({ kind, range = "" }) {
  const { min = 0, max = Infinity } = limitsIn(range);
  if (kind === "integer") return max - min >= 3 && max - min < MAX_VALUES;
  return kind === "number" && (isHalf(range) || max - min <= MAX_LENGTH);
}

/**
 * The range of a slider in whole steps, which are powers of ten. Its ends may exceed the limits, because a slider counts its
 * steps from its minimum.
 * @param {Limits} limits @param {boolean} integer
 */
export function sliderRange({ min, max }, integer) {
  const place = integer ? 0 : Math.floor(Math.log10((max - min) / SLIDER_STEPS));
  const step = Number(`1e${place}`);
  // Divisions such as 0.3 / 0.1 are not exact.
  const [first, last] = [Math.floor(min / step + 1e-6), Math.ceil(max / step - 1e-6)];
  return { min: Number(`${first}e${place}`), max: Number(`${last}e${place}`), step };
}
