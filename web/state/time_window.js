/** The shown part of the time axis, in cycles. */
import { DEPTH } from "./history.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").Span} Span */

/** Minimum cycles that the time axis shows. */
export const MIN_SPAN = 16;

/** Last cycle of the time axis. @param {State} state */
export function endOf(state) {
  return Math.max(MIN_SPAN, state.result?.summary.end_cycle ?? MIN_SPAN);
}

/** The shown part of the time axis. @param {State} state @returns {Span} */
export function shown(state) {
  return state.window ?? { start: 0, end: endOf(state) };
}

/** The cycle of the readings: under the pointer, else at a visible cursor. @param {State} state */
export function readingCycle(state) {
  const { start, end } = shown(state);
  const { a, b } = state.cursors;
  return [state.hover, a, b].find((at) => at !== null && at >= start && at <= end) ?? null;
}

/** Keeps a window inside the run and at least a few cycles long. @param {Span} window @param {number} last @returns {Span | null} */
export function clamp({ start, end }, last) {
  const length = Math.max(MIN_SPAN, last);
  const span = Math.min(length, Math.max(MIN_SPAN, Math.round(end - start)));
  const from = Math.min(Math.max(0, Math.round(start)), length - span);
  return Number.isFinite(from + span) ? { start: from, end: from + span } : null;
}

/** The window that a link requests; null if it exceeds the run or is the whole run. @param {Span} window @param {number} last @returns {Span | null} */
export function requestedWindow(window, last) {
  const inside = window.end <= last && window.end - window.start < last;
  return inside ? clamp(window, last) : null;
}

/** Shows another part of the time axis. All moves of one gesture are one step of `zooms`. @param {State} state @param {{window: Span | null, joins?: string}} message @returns {State} */
export function moveTo(state, { window: wanted, joins }) {
  const window = wanted && clamp(wanted, endOf(state));
  const gesture = joins ?? null;
  const same =
    window === state.window ||
    (window !== null && window.start === state.window?.start && window.end === state.window.end);
  if (same || (gesture !== null && gesture === state.gesture)) return { ...state, window, gesture };
  return { ...state, window, gesture, zooms: [...state.zooms, state.window].slice(-DEPTH) };
}

/** @param {State} state @returns {State} */
export function moveBack(state) {
  if (state.zooms.length === 0) return state;
  const [before] = state.zooms.slice(-1);
  return {
    ...state,
    window: before && clamp(before, endOf(state)),
    zooms: state.zooms.slice(0, -1),
    gesture: null,
  };
}
