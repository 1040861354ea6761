/** The description of a form field: name, label, unit, range and kind. */

/**
 * @typedef {object} Field
 * @property {string} key     Name in the scenario.
 * @property {string} label
 * @property {string} hint    What it is, how it is given, and its range.
 * @property {"number" | "integer" | "optional" | "optional-number" | "cycles" | "optional-cycles" | "choice" | "quantity" | "text" | "hex" | "optional-hex" | "lines" | "wholes" | "segments" | "points"} kind
 *   `optional…` may be empty (null); `cycles` also takes a time; `lines` is one hex packet a line, `wholes` one
 *   whole number, `segments` one segment, `points` one point of a curve.
 * @property {string} term    What explains it: its group and its name in the schema.
 * @property {string} [unit]
 * @property {{[value: string]: string}} [choices]
 * @property {{[unit: string]: string}} [units]  Of a quantity: JSON's name to the printed one.
 * @property {number} [rows]
 * @property {any} [initial]  What it is where the scenario does not say it.
 * @property {(value: any, state: import("../state/types.js").State) => string} [also]  The value in another light, where its kind does not say it.
 * @property {{key?: string, path?: string, is: string}} [when]  Only of use while a field beside it, or one at a path, has this value.
 *
 * @typedef {{name?: string, text: string, from?: string}} Term  What is meant, and which of the schema's documents it comes from.
 */
export {};
