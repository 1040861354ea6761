/** The history of a panel: records, inputs and ignored presses. */
import { count } from "../../state/number.js";
import { INPUTS, inputLabel, read, STATES } from "./names.js";

/** @typedef {{records: Float64Array, inputs: Map<string, {cycles: number[], levels: number[]}>, ignored: {cycle: number, input: string, state: string}[], writes: Float64Array}} Story */
/** @typedef {import("./front.js").Moment} Moment */

/** Maximum listed ignored presses. */
const MAX_LISTED = 20;

/** Index of the last value in an ascending list that is at most `value`; -1 if there is none. @param {ArrayLike<number>} list @param {number} value @param {number} [stride] */
export function lastUpTo(list, value, stride = 1) {
  let [low, high] = [0, list.length / stride];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle * stride] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** Converts the reply of the core. @param {{records: Float64Array, inputs: Float64Array, ignored: Float64Array, writes: Float64Array}} answer @returns {Story} */
export function storyFrom({ records, inputs, ignored, writes }) {
  /** @type {Story["inputs"]} */
  const changes = new Map();
  for (let i = 0; i < inputs.length; i += 3) {
    const name = INPUTS[inputs[i + 1]];
    const change = changes.get(name) ?? { cycles: [], levels: [] };
    changes.set(name, change);
    change.cycles.push(inputs[i]);
    change.levels.push(inputs[i + 2]);
  }
  const pressed = Array.from({ length: ignored.length / 3 }, (_, i) => ({
    cycle: ignored[3 * i],
    input: INPUTS[ignored[3 * i + 1]],
    state: STATES[ignored[3 * i + 2]],
  }));
  return { records, inputs: changes, ignored: pressed, writes };
}

/** Whether an input has the level 1 at a cycle. @param {Story | null} story @param {string} input @param {number} cycle */
export function levelAt(story, input, cycle) {
  const { cycles = [], levels = [] } = story?.inputs.get(input) ?? {};
  const index = lastUpTo(cycles, cycle);
  return index < 0 ? input === "power" : levels[index] === 1;
}

/** Converts the state of a panel at a cycle. @param {ArrayLike<number>} reply @returns {Moment} */
export function momentFrom(reply) {
  const [word, position, display, place, error, perUnit, decimals, powered, loops, groups] = Array.from(reply);
  return {
    ...{ word: read(word), position, display, place, error, perUnit, decimals, loops, groups },
    powered: powered === 1,
  };
}

/** The list of presses that had no effect. @param {Story} story @param {boolean} hasHome @param {(cycle: number) => string} timeOf */
export function ignoredPresses({ ignored }, hasHome, timeOf) {
  return {
    title: `${count(ignored.length)} ${ignored.length === 1 ? "press" : "presses"} ignored`,
    items: ignored.slice(0, MAX_LISTED).map(({ cycle, input, state }) => ({
      cycle,
      text: `${inputLabel(input)} at ${timeOf(cycle)} in ${state}${input === "home" && !hasHome ? ": homing is not set up" : ""}`,
    })),
    more: ignored.length > MAX_LISTED ? `and ${count(ignored.length - MAX_LISTED)} more` : "",
  };
}

/** @param {Story} story */
export function wearText({ writes }) {
  const maxWrites = writes.reduce((a, b) => Math.max(a, b), 0);
  return `Memory: the most-written cell was written ${count(maxWrites)} ${maxWrites === 1 ? "time" : "times"}.`;
}

/** @param {Story} story @param {number} panel */
export const storyLabel = ({ inputs, records }, panel) =>
  `Rows of panel ${panel}: ${inputs.size} inputs, ${count(records.length / 4)} changes of the display`;
