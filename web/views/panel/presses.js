/** Time, length and text of a press. */
import { count, si } from "../../state/number.js";
import { parseNumber } from "../../state/parse_number.js";
import { endOf } from "../../state/time_window.js";

/** @typedef {import("../../state/types.js").State} State */

/** What a press lasts longer than the debouncing, and how far after the end of a run it comes, in s. */
const BEYOND_S = 0.01;
/** Debouncing where the controller has none, in cycles. */
const DEBOUNCE_CYCLES = 160_000;
/** Maximum steps of a push. */
const MAX_PUSH = 1_000_000;

/** @param {number} clock */
const beyond = (clock) => Math.round(BEYOND_S * clock);

/** Minimum cycles of a press that is seen. @param {any} panel @param {number} clock */
export const shortestPress = (panel, clock) => (panel?.debounce_cycles ?? DEBOUNCE_CYCLES) + beyond(clock);

/** The visible cycle: of the playback, under the pointer, at the cursor, else the end. @param {State} state @param {number | null} played */
export function shownCycle(state, played) {
  const { hover, cursors } = state;
  if (played !== null) return { cycle: played, name: "live" };
  if (hover !== null) return { cycle: hover, name: "at the pointer" };
  if (cursors.a !== null) return { cycle: cursors.a, name: "at cursor A" };
  return { cycle: endOf(state), name: "at the end" };
}

/** The cycle of the next press: of the playback, at the cursor, else after the end. @param {State} state @param {number | null} played @param {number} clock */
export function pressCycle(state, played, clock) {
  const { a } = state.cursors;
  if (played !== null) return Math.max(1, played);
  return a === null ? endOf(state) + beyond(clock) : Math.max(1, a);
}

/**
 * A hold as it is typed, in cycles; null where it is empty, so that the shortest press is taken.
 * @param {string} text @param {any} panel @param {number} clock @returns {{cycles: number | null, warning: string} | {message: string}}
 */
export function parseHold(text, panel, clock) {
  if (text.trim() === "") return { cycles: null, warning: "" };
  const given = parseNumber(text, "s");
  if ("message" in given) return given;
  if (!(given.value > 0)) return { message: "A press of 0 s has no effect; enter a longer time." };
  const cycles = Math.max(1, Math.round(given.value * clock));
  const isSeen = cycles > shortestPress(panel, clock) - beyond(clock);
  return { cycles, warning: isSeen ? "" : "Not longer than the debounce time: the press has no effect." };
}

/** Why a push cannot be; empty where it can. @param {number} steps */
export function whyNoPush(steps) {
  if (steps === 0) return "A push of 0 steps has no effect; enter another number.";
  if (Math.abs(steps) > MAX_PUSH)
    return `A push has at most ${count(MAX_PUSH)} steps in either direction; push several times.`;
  return "";
}

/** @param {string} input @param {string} at @param {number} seconds */
export const pressText = (input, at, seconds) => `${input} is pressed at ${at}, for ${si(seconds, "s")}.`;
/** @param {string} input @param {number} level @param {string} at */
export const levelText = (input, level, at) => `${input} is ${level} from ${at} on.`;
/** @param {number} steps @param {string} at */
export const pushText = (steps, at) =>
  `The axis is pushed by ${count(steps)} steps at ${at}. It moves if the windings have no current.`;
