/** The pointer over the pulses: highlight and selection. */
import { unlessDropped } from "../../engine/engine.js";
import { cycleAt, onTimeAxis } from "../../time/timeline.js";
import { nearestEdge, reachOf } from "./edge_search.js";
import { rowsOf, shows } from "./rows.js";

/** @typedef {import("../../state/types.js").State} State */

/** Width of the area at the left edge that folds a channel, in CSS pixels. */
const FOLD_PX = 26;

/**
 * @param {HTMLCanvasElement} canvas
 * @param {{engine: import("../../engine/engine.js").Engine, plot: () => {left: number, right: number}, rowPx: () => number,
 *   reading: ReturnType<typeof import("./reading.js").createReading>, spans: ReturnType<typeof import("./spans.js").createSpans>,
 *   fold: (channel: number) => void} & import("../../state/types.js").Page} page
 */
export function createPointer(canvas, { engine, plot, rowPx, reading, spans, fold, dispatch, now }) {
  // First, because its listener updates the cycle under the pointer, which the listeners below read.
  onTimeAxis(canvas, plot, { dispatch, now, click: pick });
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons === 0) point(event);
  });
  canvas.addEventListener("pointerleave", () => {
    highlight(null);
    reading.span("");
  });

  /** @param {{start: number, end: number, packet?: number | null, bit?: number} | null} target */
  function highlight(target) {
    const { start, end, packet = null, bit = null } = target ?? { start: 0, end: 0 };
    dispatch({ type: "highlight", highlighted: target && { start, end, from: "pulses", packet, bit } });
  }

  /** @param {MouseEvent} event */
  const xOf = (event) => event.clientX - canvas.getBoundingClientRect().left;
  /** @param {MouseEvent} event */
  const rowAt = (event) => rowsOf(now())[Math.floor((event.clientY - canvas.getBoundingClientRect().top) / rowPx())];

  /** @param {import("./spans.js").DecodedRow} row @param {MouseEvent} event */
  function spanAt(row, event) {
    if (spans.isDense(row)) return null;
    const cycle = cycleAt(now(), plot(), xOf(event));
    return spans.spansOf(now(), row).find(({ start, end }) => start <= cycle && cycle < end) ?? null;
  }

  /** @param {PointerEvent} event */
  async function point(event) {
    const row = rowAt(event);
    const { hover } = now();
    if (!row || hover === null) {
      highlight(null);
      return reading.span("");
    }
    if (!("bit" in row)) {
      const span = spanAt(row, event);
      highlight(span && { ...span });
      return reading.span(span ? `${row.name}: ${span.texts[0]}` : "");
    }
    const pulse = await reading.signal(row.bit);
    if (!pulse || now().hover !== hover) return;
    const near = nearestEdge([pulse.begin, pulse.end], hover, reachOf(now(), plot()));
    highlight(near === null ? null : { start: near, end: near, bit: row.bit });
  }

  /** The edge of a row within a few pixels of a cycle, else the cycle. @param {number} bit @param {number} cycle */
  async function snapped(bit, cycle) {
    const reach = reachOf(now(), plot());
    const edges = await Promise.all(
      [true, false].map((forward) =>
        engine.request("next_edge", bit, forward ? cycle - 1 : cycle + 1, forward, "any").catch(unlessDropped),
      ),
    );
    return nearestEdge(edges, cycle, reach) ?? cycle;
  }

  /** Handles a click. On a signal it selects the row and sets a cursor, snapped to an edge. On a packet it selects the packet. @param {PointerEvent} event @param {number} at */
  function pick(event, at) {
    const row = rowAt(event);
    if (!row) return false;
    const x = xOf(event);
    if (x < FOLD_PX && "channel" in row && row.channel !== undefined) {
      fold(row.channel);
      return true;
    }
    if ("bit" in row && !shows(row, now().row)) dispatch({ type: "row", row: row.bit });
    if (x < plot().left) return true;
    if ("bit" in row) return snapped(row.bit, at);
    const found = spanAt(row, event)?.packet ?? null;
    if (found !== null) dispatch({ type: "packet", packet: found });
    return found !== null;
  }
  return { snapped };
}
