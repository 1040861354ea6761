/** Where the form shows each problem: at a field, at a part, or only in the list. */
import { pretty } from "../state/number.js";
import { withLabels } from "./schema.js";

/** @typedef {import("../state/types.js").Problem} Problem */
/** @typedef {{fields: Map<string, string>, parts: Map<string, string>, others: Problem[]}} Places  Messages by the path of a field or of a part. */

/** Drafts are problems, too; they replace those of the value before. @param {Pick<import("../state/types.js").State, "drafts" | "validation">} state @returns {Problem[]} */
export function problemsOf({ drafts, validation }) {
  const paths = Object.keys(drafts);
  const isDraft = (/** @type {string} */ path) => paths.some((at) => isIn(path, at) || isIn(at, path));
  return [
    ...Object.entries(drafts).map(([path, { message }]) => ({ path, message })),
    ...(validation?.problems ?? []).filter(({ path }) => !isDraft(path)),
  ].map(({ path, message }) => ({ path, message: pretty(withLabels(message)) }));
}

/** @param {Problem[]} problems @param {Map<string, unknown>} fields @param {Map<string, unknown>} parts  By their paths. @returns {Places} */
export function placed(problems, fields, parts) {
  /** @type {Places} */
  const places = { fields: new Map(), parts: new Map(), others: [] };
  for (const { path, message } of problems) {
    const field = nearest(path, fields);
    const part = field === null ? nearest(path, parts) : null;
    const line = field !== null && path.slice(field.length).match(/^\[(\d+)\]/);
    if (field !== null) add(places.fields, field, line ? `Line ${Number(line[1]) + 1}: ${message}.` : message);
    else if (part !== null) add(places.parts, part, message);
    else places.others.push({ path, message });
  }
  return places;
}

/** Whether a path is another one, or of something in it. @param {string} path @param {string} other */
function isIn(path, other) {
  return path.startsWith(other) && /^([.[]|$)/.test(path.slice(other.length));
}

/** The longest path that is the problem's own or leads to it. @param {string} path @param {Map<string, unknown>} places */
function nearest(path, places) {
  for (let at = path; at; at = at.replace(/(\.[^.[\]]+|\[\d+\])$|^[^.[\]]+$/, "")) if (places.has(at)) return at;
  // A quantity's problem may name its unit's value further down, never further up.
  return null;
}

/** @param {Map<string, string>} map @param {string} path @param {string} message */
function add(map, path, message) {
  const before = map.get(path);
  map.set(path, before ? `${before} ${message}` : message);
}
