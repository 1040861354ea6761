/** How one field of the form is described: its name in the scenario, its label and unit, its range in words, and how it is typed. */

/**
 * @typedef {object} Field
 * @property {string} key     Name in the scenario.
 * @property {string} label
 * @property {string} hint    How it is given, and its range.
 * @property {"number" | "integer" | "optional" | "optional-number" | "cycles" | "optional-cycles" | "choice" | "quantity" | "text" | "hex" | "optional-hex" | "lines" | "segments" | "points"} kind
 *   `optional…` may be empty (null); `cycles` also takes a time; `lines` is one hex packet a line, `segments` one
 *   segment, `points` one point of a curve.
 * @property {string} [term]  Its explanation in `help/terms.js`, where it is not that of its key.
 * @property {string} [unit]
 * @property {{[value: string]: string}} [choices]
 * @property {{[unit: string]: string}} [units]  Of a quantity: JSON's name to the printed one.
 * @property {number} [rows]
 * @property {{key?: string, path?: string, is: string}} [when]  Only of use while a field beside it, or one at a path, has this value.
 *
 * @typedef {{name?: string, text: string, from?: string}} Term  What is meant, and which of `DOCUMENTS` in `help/terms.js` it comes from.
 * @typedef {{label: string, fields: Field[], about: Term, terms?: {[id: string]: Term}}} Kind  One of several that can be chosen, with
 *   its own fields, and the terms that only they have.
 */

export const DISTANCE = { steps: "steps", mm: "mm", deg: "°" };
export const SPEED = { steps_s: "steps/s", mm_s: "mm/s", deg_s: "°/s", rpm: "rpm" };
export const ACCELERATION = { steps_s2: "steps/s²", mm_s2: "mm/s²", deg_s2: "°/s²" };
export const JERK = { steps_s3: "steps/s³", mm_s3: "mm/s³", deg_s3: "°/s³" };

/** @param {string} key @param {string} label @param {string} unit @param {string} hint @returns {Field} */
export const number = (key, label, unit, hint) => ({ key, label, unit, hint, kind: "number" });
/** @param {string} key @param {string} label @param {string} unit @param {string} hint @returns {Field} */
export const integer = (key, label, unit, hint) => ({ key, label, unit, hint, kind: "integer" });
/** @param {string} key @param {string} label @param {string} hint @returns {Field} */
export const cycles = (key, label, hint) => ({
  key,
  label,
  unit: "cycles",
  hint: `${hint} A time such as 2.5 us is taken too.`,
  kind: "cycles",
});
/** @param {string} key @param {string} label @param {{[unit: string]: string}} units @param {string} hint @returns {Field} */
export const quantity = (key, label, units, hint) => ({ key, label, units, hint, kind: "quantity" });
/** @param {string} key @param {string} label @param {{[value: string]: string}} choices @param {string} hint @returns {Field} */
export const choice = (key, label, choices, hint) => ({ key, label, choices, hint, kind: "choice" });
