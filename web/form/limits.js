/** The limits of a number in the form, and whether a slider suits it. */
import { get } from "../state/paths.js";

/** @typedef {import("./field.js").Field} Field */
/** @typedef {{min: number, max: number}} Limits  In the unit of the field; infinite if unknown. */

/** Maximum values of a slider for whole numbers, and the greatest length of a range of other numbers. */
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

/** The step of a slider: a power of ten. @param {Limits} limits @param {boolean} integer */
export function sliderStep({ min, max }, integer) {
  return integer ? 1 : Number(`1e${Math.floor(Math.log10((max - min) / SLIDER_STEPS))}`);
}
