/** Finds edges near a cycle and rows for keys. */
import { time } from "../../state/number.js";
import { shown } from "../../state/time_window.js";
import { shows } from "./rows.js";

/** @typedef {import("../../state/types.js").State} State */

/** A cursor snaps to an edge within this distance, in CSS pixels. */
const SNAP_PX = 6;

/** The snap distance in cycles. @param {State} state @param {{left: number, right: number}} plot */
export function reachOf(state, { left, right }) {
  const { start, end } = shown(state);
  return (SNAP_PX * (end - start)) / (right - left);
}

/** The edge nearest to a cycle within a distance; null if there is none. @param {(number | null | undefined)[]} edges @param {number} cycle @param {number} reach */
export function nearestEdge(edges, cycle, reach) {
  const near = edges.filter((edge) => typeof edge === "number" && Math.abs(edge - cycle) <= reach);
  const [nearest] = near.sort((a, b) => Math.abs(Number(a) - cycle) - Math.abs(Number(b) - cycle));
  return nearest ?? null;
}

/** The start of a search for an edge: cursor A if it is visible, else the start or end of the window. @param {State} state @param {boolean} forward */
export function searchStart(state, forward) {
  const { start, end } = shown(state);
  const { a } = state.cursors;
  return a !== null && a >= start && a <= end ? a : forward ? start : end;
}

/** @param {string} name  Of the row. @param {string} kind  `any`, `rise` or `fall`. @param {boolean} forward @param {number | null} edge @param {number} clock */
export function jumpText(name, kind, forward, edge, clock) {
  const direction = { rise: "rising ", fall: "falling " }[kind] ?? "";
  if (edge === null) return `${name}: no ${forward ? "later" : "earlier"} ${direction}edge.`;
  return `${name}: ${direction}edge at ${time(edge / clock)}, cycle ${edge}.`;
}

/** The signal above or below the selected one. @param {import("./rows.js").Row[]} rows @param {number} selected @param {number} by */
export function rowAfter(rows, selected, by) {
  const signals = rows.flatMap((row) => ("bit" in row ? [row] : []));
  const at = signals.findIndex((row) => shows(row, selected));
  return signals[Math.min(signals.length - 1, Math.max(0, at + by))];
}
