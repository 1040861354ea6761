/** The groups of a program: references between them, and lengths in units. */
import { count } from "../state/number.js";

/** The field with the number of another group, by the kind of group. @type {{[kind: string]: string}} */
const REFERENCES = { repeat: "first", wait: "then", jump: "to" };

/** Updates references after groups were renumbered. @param {any[]} groups @param {(number: number) => number} to  The new number of a group, from 1. */
function renumbered(groups, to) {
  return groups.map((group) => {
    const [kind] = Object.keys(group);
    const key = REFERENCES[kind];
    const number = key && group[kind][key];
    return Number.isInteger(number) ? { [kind]: { ...group[kind], [key]: to(number) } } : group;
  });
}

/** The program without a group. References to it become references to the next group, or to the last one. @param {any[]} groups @param {number} index */
export function withoutGroup(groups, index) {
  const to = (/** @type {number} */ number) => Math.max(1, number > index + 1 ? number - 1 : number);
  const remaining = renumbered(groups.toSpliced(index, 1), to);
  return renumbered(remaining, (number) => Math.min(number, remaining.length));
}

/** The program with a group and its predecessor exchanged. @param {any[]} groups @param {number} index */
export function withRaisedGroup(groups, index) {
  const to = (/** @type {number} */ number) => (number === index + 1 ? index : number === index ? index + 1 : number);
  return renumbered(groups.toSpliced(index - 1, 2, groups[index], groups[index - 1]), to);
}

/** A length in units and in steps; empty if it is invalid. @param {any} length  In digits. @param {{decimals?: any, pulses_per_unit?: any}} panel */
export function lengthText(length, { decimals, pulses_per_unit }) {
  if (!Number.isInteger(length) || !(decimals >= 0 && decimals <= 3) || !(pulses_per_unit > 0)) return "";
  const scale = 10 ** decimals;
  const steps = Math.floor((2 * length * pulses_per_unit + scale) / (2 * scale));
  return `= ${(length / scale).toFixed(decimals)} units, ${count(steps)} steps`;
}
