/** Changes of the script of panel inputs; errors are returned as text. */
import { inputLabel, SHARED } from "./names.js";

/** @typedef {{cycle: number, input: string | null, level: number, push_steps: number | null}} Entry */
/** @typedef {{inputs: Entry[]} | {refused: string}} Changed */

/** Maximum inputs of a script. */
const MAX_INPUTS = 100_000;

/** The inputs that the virtual axis drives, with the field that sets them up. @param {any} axis @returns {{[input: string]: string}} */
export function driven(axis) {
  const isSet = (/** @type {any} */ value) => value !== null && value !== undefined;
  return {
    ...(isSet(axis?.min_switch_at_steps) ? { limit_min: "the left switch of the virtual axis" } : {}),
    ...(isSet(axis?.max_switch_at_steps) ? { limit_max: "the right switch of the virtual axis" } : {}),
    ...(isSet(axis?.home_from_steps) && isSet(axis?.home_to_steps)
      ? { home_switch: "the home switch of the virtual axis" }
      : {}),
  };
}

/** The controller whose script contains an input. @param {number} controller @param {string | null} input */
export const ownerOf = (controller, input) => (input !== null && SHARED.includes(input) ? 0 : controller);

/**
 * Adds an entry, in the order of time.
 * @param {Entry[]} inputs @param {Omit<Entry, "push_steps"> & {push_steps?: number}} entry @param {any} axis
 * @param {(cycle: number) => string} timeOf  Prints a cycle as a time. @returns {Changed}
 */
export function put(inputs, { cycle, input, level, push_steps }, axis, timeOf) {
  const driver = input && driven(axis)[input];
  if (driver)
    return {
      refused: `The ${inputLabel(input)} is driven by ${driver}; remove that switch in the form to set it by hand.`,
    };
  if (inputs.length >= MAX_INPUTS)
    return { refused: `The maximum of ${MAX_INPUTS} inputs is reached; remove one first.` };
  const at = Math.max(1, Math.round(cycle));
  if (inputs.some((each) => each.cycle === at && each.input === input))
    return {
      refused: `${subjectOf(input)} already changes at ${timeOf(at)}; move the cursor or that diamond.`,
    };
  const index = inputs.findLastIndex((each) => each.cycle <= at) + 1;
  return { inputs: inputs.toSpliced(index, 0, { cycle: at, input, level, push_steps: push_steps ?? null }) };
}

/** The subject of a sentence about an input, or about a push. @param {string | null} input */
const subjectOf = (input) => (input === null ? "A push" : `The input “${inputLabel(input)}”`);

/** Adds a press and release of a button. @param {Entry[]} inputs @param {string} input @param {number} from @param {number} until @param {any} axis @param {(cycle: number) => string} timeOf @returns {Changed} */
export function press(inputs, input, from, until, axis, timeOf) {
  const before = inputs.findLast((each) => each.input === input && each.cycle < from);
  if (before?.level === 1)
    return {
      refused: `${subjectOf(input)} is already pressed at ${timeOf(from)}, since ${timeOf(before.cycle)}; move the cursor past that press.`,
    };
  const next = inputs.find((each) => each.input === input && each.cycle > from);
  if (next && next.cycle <= until)
    return {
      refused: `${subjectOf(input)} is pressed again at ${timeOf(next.cycle)}, before this press ends; move the cursor, or use a shorter hold.`,
    };
  const down = put(inputs, { cycle: from, input, level: 1 }, axis, timeOf);
  return "refused" in down ? down : put(down.inputs, { cycle: until, input, level: 0 }, axis, timeOf);
}

/** Moves an entry to another cycle. @param {Entry[]} inputs @param {number} index @param {number} cycle @param {(cycle: number) => string} timeOf @returns {Changed & {index?: number}} */
export function moved(inputs, index, cycle, timeOf) {
  const entry = inputs[index];
  const at = Math.max(1, Math.round(cycle));
  if (at === entry.cycle) return { inputs, index };
  const others = inputs.toSpliced(index, 1);
  if (others.some((each) => each.cycle === at && each.input === entry.input))
    return { refused: `${subjectOf(entry.input)} would change twice at ${timeOf(at)}; use another time.` };
  const newIndex = others.findLastIndex((each) => each.cycle <= at) + 1;
  return { inputs: others.toSpliced(newIndex, 0, { ...entry, cycle: at }), index: newIndex };
}

/** The name of an entry. @param {Entry} entry */
export function nameOf({ input, level, push_steps }) {
  return input === null ? `push by ${push_steps} steps` : `${inputLabel(input)} ${level ? "1" : "0"}`;
}

/** @typedef {{owner: number, index: number, entry: Entry}} Placed  An entry, the controller of its script, and its index there. */

/** @param {any[]} panels  Settings of all controllers. @param {number} owner @returns {Entry[]} */
export const inputsOf = (panels, owner) => panels[owner]?.inputs ?? [];

/** All entries for a controller in the order of time: its own entries, and the shared entries of the first controller. @param {any[]} panels @param {number} controller @returns {Placed[]} */
export function entriesOf(panels, controller) {
  const of = (/** @type {number} */ owner) => inputsOf(panels, owner).map((entry, index) => ({ owner, index, entry }));
  if (controller === 0) return of(0);
  const shared = of(0).filter(({ entry }) => entry.input !== null && SHARED.includes(entry.input));
  return [...of(controller), ...shared].sort((a, b) => a.entry.cycle - b.entry.cycle);
}

/** Finds an entry again after a change of the scripts. @param {any[]} panels @param {Placed} placed @returns {Placed | null} */
export function sameEntry(panels, { owner, entry }) {
  const inputs = inputsOf(panels, owner);
  const index = inputs.findIndex((each) => JSON.stringify(each) === JSON.stringify(entry));
  return index < 0 ? null : { owner, index, entry: inputs[index] };
}
