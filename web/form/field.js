/** The description of a form field: name, label, unit, range and kind. */

/**
 * @typedef {object} Field
 * @property {string} key     Name in the scenario.
 * @property {string} label
 * @property {string} hint    Its meaning, format and range.
 * @property {"number" | "integer" | "optional" | "optional-number" | "cycles" | "optional-cycles" | "choice" | "quantity" | "optional-quantity" | "text" | "hex" | "optional-hex" | "lines" | "wholes" | "segments" | "points"} kind
 *   `optional…` may be empty (null); `cycles` also accepts a time. Lists with one item per line: `lines` of hex packets,
 *   `wholes` of whole numbers, `segments`, and `points` of a curve.
 * @property {string} term    Id of its help text: its group and name in the schema.
 * @property {string} [unit]
 * @property {string} [range]  Allowed values as text.
 * @property {{[value: string]: string}} [choices]
 * @property {{[unit: string]: string}} [units]  Labels of the units of a quantity, by their names in JSON.
 * @property {number} [rows]
 * @property {any} [initial]  Its value if the scenario has none.
 * @property {(value: any, state: import("../state/types.js").State) => string} [also]  Additional meaning of a value, such as a length in units.
 * @property {{key?: string, path?: string, is: string}} [when]  Visible only while another field of its group, or the one at a path, has this value.
 *
 * @typedef {{name?: string, text: string, from?: string}} Term  A help text; `from` is the id of its paper.
 */
export {};
