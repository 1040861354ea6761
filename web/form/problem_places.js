/** Where the form shows each problem: at a field, at a part, or only in the list. */
import { pretty } from "../state/number.js";
import { pathText, withLabels } from "./schema.js";

/** @typedef {import("../state/types.js").Problem} Problem */
/** @typedef {{fields: Map<string, string>, parts: Map<string, string>, others: Problem[]}} AssignedProblems  Messages by the path of a field or of a part. */

/** All problems. Problems of drafts replace the problems of their previous values. @param {Pick<import("../state/types.js").State, "drafts" | "validation">} state @returns {Problem[]} */
export function problemsOf({ drafts, validation }) {
  const paths = Object.keys(drafts);
  const isDraft = (/** @type {string} */ path) => paths.some((at) => isIn(path, at) || isIn(at, path));
  return [
    ...Object.entries(drafts).map(([path, { message }]) => ({ path, message })),
    ...(validation?.problems ?? []).filter(({ path }) => !isDraft(path)),
  ].map(({ path, message }) => ({ path, message: messageText(message) }));
}

/** A message of the core as the page prints it. @param {string} message */
const messageText = (message) => pretty(withLabels(message));

/** A problem as text, with the label of its field instead of its path. @param {Problem} problem */
export const problemText = ({ path, message }) =>
  path ? `${pathText(path)}: ${messageText(message)}` : messageText(message);

/** Assigns problems to fields and parts. @param {Problem[]} problems @param {Map<string, unknown>} fields @param {Map<string, unknown>} parts  By their paths. @returns {AssignedProblems} */
export function assignProblems(problems, fields, parts) {
  /** @type {AssignedProblems} */
  const assigned = { fields: new Map(), parts: new Map(), others: [] };
  for (const { path, message } of problems) {
    const field = nearest(path, fields);
    const part = field === null ? nearest(path, parts) : null;
    const line = field !== null && path.slice(field.length).match(/^\[(\d+)\]/);
    if (field !== null) add(assigned.fields, field, line ? `Line ${Number(line[1]) + 1}: ${message}.` : message);
    else if (part !== null) add(assigned.parts, part, message);
    else assigned.others.push({ path, message });
  }
  return assigned;
}

/** Whether a path is equal to another one, or within it. @param {string} path @param {string} other */
function isIn(path, other) {
  return path.startsWith(other) && /^([.[]|$)/.test(path.slice(other.length));
}

/** The longest known path that is the problem's own or leads to it. @param {string} path @param {Map<string, unknown>} known */
function nearest(path, known) {
  for (let at = path; at; at = at.replace(/(\.[^.[\]]+|\[\d+\])$|^[^.[\]]+$/, "")) if (known.has(at)) return at;

  return null;
}

/** @param {Map<string, string>} map @param {string} path @param {string} message */
function add(map, path, message) {
  const before = map.get(path);
  map.set(path, before ? `${before} ${message}` : message);
}
