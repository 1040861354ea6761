/** Draws highlight, pointer, cursors and markers over the views of the time axis. */
import { color } from "./plot.js";
import { pixelOf } from "./timeline.js";

/** @typedef {import("../state/types.js").State} State */

/**
 * Draws the highlight, the zoom box, and the lines of pointer, cursors and markers.
 * @param {CanvasRenderingContext2D} context
 * @param {State} state
 * @param {{left: number, right: number}} plot
 * @param {number} height
 */
export function drawCursors(context, state, plot, height) {
  /** @param {number | null} cycle @param {string} ink @param {number[]} dash @param {number} [width] */
  const line = (cycle, ink, dash, width = 1) => {
    if (cycle === null) return;
    const x = Math.round(pixelOf(state, plot, cycle)) + 0.5;
    if (x < plot.left - 1 || x > plot.right + 1) return;
    context.strokeStyle = color(ink);
    context.setLineDash(dash);
    context.lineWidth = width;
    context.beginPath();
    context.moveTo(x, 0);
    context.lineTo(x, height);
    context.stroke();
  };
  /** @param {{start: number, end: number}} span @param {string} ink @param {number} opacity */
  const band = ({ start, end }, ink, opacity) => {
    const [from, to] = [start, end].map((cycle) =>
      Math.min(plot.right, Math.max(plot.left, pixelOf(state, plot, cycle))),
    );
    context.fillStyle = color(ink);
    context.globalAlpha = opacity;
    if (end >= start && from < plot.right && to > plot.left) context.fillRect(from, 0, Math.max(2, to - from), height);
    context.globalAlpha = 1;
  };
  if (state.highlighted) band(state.highlighted, "--mark", 0.3);
  if (state.picked) {
    band(state.picked, "--accent", 0.18);
    line(state.picked.start, "--accent", []);
    line(state.picked.end, "--accent", []);
  }
  line(state.hover, "--axis", [3, 3]);
  for (const cycle of state.markers) line(cycle, "--accent", [2, 2], 1.5);
  line(state.cursors.a, "--cursor-a", [], 1.5);
  line(state.cursors.b, "--cursor-b", [5, 3], 1.5);
}

/** Whether the highlight, the pointer, the cursors, the markers or the zoom box have changed. @param {State | undefined} before @param {State} state */
export function hasOverlayChanged(before, state) {
  return (
    before?.hover !== state.hover ||
    before?.highlighted !== state.highlighted ||
    before?.cursors !== state.cursors ||
    before?.markers !== state.markers ||
    before?.picked !== state.picked
  );
}
