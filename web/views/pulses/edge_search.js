/** Finds edges near a cycle and rows for keys. */
import { time } from "../../state/number.js";
import { shown } from "../../state/time_window.js";
import { shows } from "./rows.js";

/** @typedef {import("../../state/types.js").State} State */

/** A cursor that is set this near to an edge is set on it, in CSS pixels. */
const SNAP_PX = 6;

/** Cycles within the reach of a pointer. @param {State} state @param {{left: number, right: number}} plot */
export function reachOf(state, { left, right }) {
  const { start, end } = shown(state);
  return (SNAP_PX * (end - start)) / (right - left);
}

/** The edge nearest to a cycle and within reach of it; null if there is none. @param {(number | null | undefined)[]} edges @param {number} cycle @param {number} reach */
export function nearestEdge(edges, cycle, reach) {
  const near = edges.filter((edge) => typeof edge === "number" && Math.abs(edge - cycle) <= reach);
  const [first] = near.sort((a, b) => Math.abs(Number(a) - cycle) - Math.abs(Number(b) - cycle));
  return first ?? null;
}

/** Where the search for the next edge begins: at cursor A if it is in sight, else at the window's end. @param {State} state @param {boolean} forward */
export function searchStart(state, forward) {
  const { start, end } = shown(state);
  const { a } = state.cursors;
  return a !== null && a >= start && a <= end ? a : forward ? start : end;
}

/** @param {string} name  Of the row. @param {string} kind  As the choice has it. @param {boolean} forward @param {number | null} edge @param {number} clock */
export function jumpText(name, kind, forward, edge, clock) {
  const which = { rise: "rising ", fall: "falling " }[kind] ?? "";
  if (edge === null) return `${name}: no ${forward ? "later" : "earlier"} ${which}edge.`;
  return `${name}: ${which}edge at ${time(edge / clock)}, cycle ${edge}.`;
}

/** The signal above or below the selected one. @param {import("./rows.js").Row[]} rows @param {number} selected @param {number} by */
export function rowAfter(rows, selected, by) {
  const signals = rows.flatMap((row) => ("bit" in row ? [row] : []));
  const at = signals.findIndex((row) => shows(row, selected));
  return signals[Math.min(signals.length - 1, Math.max(0, at + by))];
}
