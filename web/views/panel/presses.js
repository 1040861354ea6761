/** Time, length and text of a press. */
import { count, si } from "../../state/number.js";
import { parseNumber } from "../../state/parse_number.js";
import { endOf } from "../../state/time_window.js";
import { inputLabel } from "./names.js";

/** @typedef {import("../../state/types.js").State} State */

/** A press is this much longer than the debounce time, and this far after the end of a run, in s. */
const MARGIN_S = 0.01;
/** Debounce time if the settings have none, in cycles. */
const DEBOUNCE_CYCLES = 160_000;
/** Maximum steps of a push. */
const MAX_PUSH = 1_000_000;

/** @param {number} clock */
const margin = (clock) => Math.round(MARGIN_S * clock);

/** Minimum cycles of a press that has an effect. @param {any} panel @param {number} clock */
export const shortestPress = (panel, clock) => (panel?.debounce_cycles ?? DEBOUNCE_CYCLES) + margin(clock);

/** The visible cycle: of the playback, at the pointer, at cursor A, or at the end. @param {State} state @param {number | null} played */
export function shownCycle(state, played) {
  const { hover, cursors } = state;
  if (played !== null) return { cycle: played, name: "live" };
  if (hover !== null) return { cycle: hover, name: "at the pointer" };
  if (cursors.a !== null) return { cycle: cursors.a, name: "at cursor A" };
  return { cycle: endOf(state), name: "at the end" };
}

/** The cycle of the next press: of the playback, at cursor A, or after the end. @param {State} state @param {number | null} played @param {number} clock */
export function pressCycle(state, played, clock) {
  const { a } = state.cursors;
  if (played !== null) return Math.max(1, played);
  return a === null ? endOf(state) + margin(clock) : Math.max(1, a);
}

/**
 * Reads a hold time in cycles; null if it is empty, which means the shortest press.
 * @param {string} text @param {any} panel @param {number} clock @returns {{cycles: number | null, warning: string} | {message: string}}
 */
export function parseHold(text, panel, clock) {
  if (text.trim() === "") return { cycles: null, warning: "" };
  const parsed = parseNumber(text, "s");
  if ("message" in parsed) return parsed;
  if (!(parsed.value > 0)) return { message: "A press of 0 s has no effect; use a longer time." };
  const cycles = Math.max(1, Math.round(parsed.value * clock));
  const hasEffect = cycles > shortestPress(panel, clock) - margin(clock);
  return { cycles, warning: hasEffect ? "" : "Not longer than the debounce time: the press has no effect." };
}

/** Why a push is invalid; empty if it is valid. @param {number} steps */
export function whyNoPush(steps) {
  if (steps === 0) return "A push of 0 steps has no effect; use another number.";
  if (Math.abs(steps) > MAX_PUSH)
    return `A push of ${count(steps)} steps is too far; use at most ${count(MAX_PUSH)} steps in each direction.`;
  return "";
}

/** @param {string} text */
const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** @param {string} input @param {string} at @param {number} seconds */
export const pressText = (input, at, seconds) =>
  `${capital(inputLabel(input))} is pressed at ${at} for ${si(seconds, "s")}.`;
/** @param {string} input @param {number} level @param {string} at */
export const levelText = (input, level, at) => `${capital(inputLabel(input))} is ${level} from ${at} on.`;
/** @param {number} steps @param {string} at */
export const pushText = (steps, at) =>
  `The axis is pushed by ${count(steps)} steps at ${at}. It moves if the windings have no current.`;
