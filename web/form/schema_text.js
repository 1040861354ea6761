/** Hints and texts of the schema as the page prints them. */

/** @typedef {import("./schema.js").Row} Row */
/** @typedef {import("./schema.js").Word} Word */
/** @typedef {(name: string) => string | undefined} LabelAt  The label of a field or word. */

/** The hint of a field: its text, its range, and the meaning of an empty field. @param {Pick<Row, "text" | "range" | "empty" | "unit">} row @param {Word[]} words @param {LabelAt} labelAt */
export function hintOf({ text, range, empty, unit }, words, labelAt) {
  const described = words.filter(({ label, text }) => text !== label);
  const parts = [
    text,
    ...described.map(({ label, text }) => capital(text.startsWith(label) ? text : `${label}: ${text}`)),
    capital(range),
    empty && `Empty: ${empty}`,
    unit === "cycles" || unit === "ns" ? "Or a time, such as 2.5 us" : "",
  ];
  return parts
    .filter((part) => part)
    .map((part) => plain(/** @type {string} */ (part), labelAt).replace(/\.?$/, "."))
    .join(" ");
}

/** @param {string} text */
const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** Text of the documentation as the page prints it. @param {string} text @param {LabelAt} labelAt */
export function plain(text, labelAt) {
  const raised = (/** @type {string} */ digits) =>
    [...digits].map((digit) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(digit)]).join("");
  return text
    .replace(/`([\w.]+)`/g, (_, name) => labelAt(name) ?? name)
    .replaceAll("`", "")
    .replace(/\^(-?\d+)/g, (_, digits) => raised(digits))
    .replace(/(?<=\w)\*(?=\w)/g, " · ")
    .replace(/ - (?=\d)/g, " − ")
    .replace(/(?<!\S)-(?=\d)/g, "−");
}
