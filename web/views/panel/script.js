/** Changes of the script of panel inputs; errors are returned as text. */
import { SHARED } from "./names.js";

/** @typedef {{cycle: number, input: string | null, level: number, push_steps: number | null}} Entry */
/** @typedef {{inputs: Entry[]} | {refused: string}} Changed */

/** Inputs that a script may have. */
const MAX_INPUTS = 100_000;

/** What a controller's axis drives, and by which field. @param {any} axis @returns {{[input: string]: string}} */
export function driven(axis) {
  const given = (/** @type {any} */ value) => value !== null && value !== undefined;
  return {
    ...(given(axis?.min_switch_at_steps) ? { limit_min: "axis.min_switch_at_steps" } : {}),
    ...(given(axis?.max_switch_at_steps) ? { limit_max: "axis.max_switch_at_steps" } : {}),
    ...(given(axis?.home_from_steps) && given(axis?.home_to_steps) ? { home_switch: "axis.home_from_steps" } : {}),
  };
}

/** The controller whose script has an input. @param {number} controller @param {string | null} input */
export const ownerOf = (controller, input) => (input !== null && SHARED.includes(input) ? 0 : controller);

/**
 * One more entry, in the order of time.
 * @param {Entry[]} inputs @param {Omit<Entry, "push_steps"> & {push_steps?: number}} entry @param {any} axis
 * @param {(cycle: number) => string} timeOf  As the page prints it. @returns {Changed}
 */
export function put(inputs, { cycle, input, level, push_steps }, axis, timeOf) {
  const by = input && driven(axis)[input];
  if (by) return { refused: `${input} is driven by the axis (${by}); remove that in the form to switch it by hand.` };
  if (inputs.length >= MAX_INPUTS)
    return { refused: `The maximum of ${MAX_INPUTS} inputs is reached; remove one first.` };
  const at = Math.max(1, Math.round(cycle));
  if (inputs.some((each) => each.cycle === at && each.input === input))
    return {
      refused: `${input ?? "A push"} already changes at ${timeOf(at)}; move the cursor or that diamond.`,
    };
  const behind = inputs.findLastIndex((each) => each.cycle <= at) + 1;
  return { inputs: inputs.toSpliced(behind, 0, { cycle: at, input, level, push_steps: push_steps ?? null }) };
}

/** A button that is pressed and let go. @param {Entry[]} inputs @param {string} input @param {number} from @param {number} until @param {any} axis @param {(cycle: number) => string} timeOf @returns {Changed} */
export function press(inputs, input, from, until, axis, timeOf) {
  const before = inputs.findLast((each) => each.input === input && each.cycle < from);
  if (before?.level === 1)
    return {
      refused: `${input} is already pressed at ${timeOf(from)}, since ${timeOf(before.cycle)}; move the cursor past that press.`,
    };
  const next = inputs.find((each) => each.input === input && each.cycle > from);
  if (next && next.cycle <= until)
    return {
      refused: `${input} is pressed again at ${timeOf(next.cycle)}, before this press ends; move the cursor, or use a shorter hold.`,
    };
  const down = put(inputs, { cycle: from, input, level: 1 }, axis, timeOf);
  return "refused" in down ? down : put(down.inputs, { cycle: until, input, level: 0 }, axis, timeOf);
}

/** An entry in another cycle. @param {Entry[]} inputs @param {number} index @param {number} cycle @param {(cycle: number) => string} timeOf @returns {Changed & {index?: number}} */
export function moved(inputs, index, cycle, timeOf) {
  const entry = inputs[index];
  const at = Math.max(1, Math.round(cycle));
  if (at === entry.cycle) return { inputs, index };
  const others = inputs.toSpliced(index, 1);
  if (others.some((each) => each.cycle === at && each.input === entry.input))
    return { refused: `${entry.input ?? "A push"} would change twice at ${timeOf(at)}; it is not moved.` };
  const behind = others.findLastIndex((each) => each.cycle <= at) + 1;
  return { inputs: others.toSpliced(behind, 0, { ...entry, cycle: at }), index: behind };
}

/** How it is called. @param {Entry} entry */
export function nameOf({ input, level, push_steps }) {
  return input === null ? `push by ${push_steps}` : `${input} ${level ? "1" : "0"}`;
}

/** @typedef {{owner: number, index: number, entry: Entry}} Placed  An entry, the controller whose script it is in, and its place there. */

/** @param {any[]} panels  Settings of all controllers. @param {number} owner @returns {Entry[]} */
export const inputsOf = (panels, owner) => panels[owner]?.inputs ?? [];

/** All entries that a controller obeys, in the order of time: its own, and those of the first one that are shared. @param {any[]} panels @param {number} controller @returns {Placed[]} */
export function entriesOf(panels, controller) {
  const of = (/** @type {number} */ owner) => inputsOf(panels, owner).map((entry, index) => ({ owner, index, entry }));
  if (controller === 0) return of(0);
  const shared = of(0).filter(({ entry }) => entry.input !== null && SHARED.includes(entry.input));
  return [...of(controller), ...shared].sort((a, b) => a.entry.cycle - b.entry.cycle);
}

/** The same entry in scripts that may have changed. @param {any[]} panels @param {Placed} placed @returns {Placed | null} */
export function sameEntry(panels, { owner, entry }) {
  const inputs = inputsOf(panels, owner);
  const index = inputs.findIndex((each) => JSON.stringify(each) === JSON.stringify(entry));
  return index < 0 ? null : { owner, index, entry: inputs[index] };
}
