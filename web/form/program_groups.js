/** The groups of a program: references between them, and lengths in units. */
import { count } from "../state/number.js";

/** Groups that a group names, by its kind. @type {{[kind: string]: string}} */
const NAMED = { repeat: "first", wait: "then", jump: "to" };

/** Groups whose numbers have changed: those that name them still mean the same ones. @param {any[]} groups @param {(number: number) => number} to  New numbers, from 1. */
function renumbered(groups, to) {
  return groups.map((group) => {
    const [kind] = Object.keys(group);
    const key = NAMED[kind];
    const number = key && group[kind][key];
    return Number.isInteger(number) ? { [kind]: { ...group[kind], [key]: to(number) } } : group;
  });
}

/** The program without a group: those that named it name the one after it, or the last. @param {any[]} groups @param {number} index */
export function withoutGroup(groups, index) {
  const to = (/** @type {number} */ number) => Math.max(1, number > index + 1 ? number - 1 : number);
  const left = renumbered(groups.toSpliced(index, 1), to);
  return renumbered(left, (number) => Math.min(number, left.length));
}

/** The program with a group before its predecessor. @param {any[]} groups @param {number} index */
export function withRaisedGroup(groups, index) {
  const to = (/** @type {number} */ number) => (number === index + 1 ? index : number === index ? index + 1 : number);
  return renumbered(groups.toSpliced(index - 1, 2, groups[index], groups[index - 1]), to);
}

/** A length in units and in steps; empty where it has none. @param {any} length  In digits. @param {{decimals?: any, pulses_per_unit?: any}} panel */
export function lengthText(length, { decimals, pulses_per_unit }) {
  if (!Number.isInteger(length) || !(decimals >= 0 && decimals <= 3) || !(pulses_per_unit > 0)) return "";
  const scale = 10 ** decimals;
  const steps = Math.floor((2 * length * pulses_per_unit + scale) / (2 * scale));
  return `= ${(length / scale).toFixed(decimals)} units, ${count(steps)} steps`;
}
