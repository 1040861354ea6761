/** Draws the logic view with its highlights. */

import { rowPx } from "../../state/row_choices.js";
import { shown } from "../../state/time_window.js";
import { color, fit, ratio } from "../../time/plot.js";
import { pixelOf } from "../../time/timeline.js";
import { paintSignal, paintSpans, paintTint } from "./paint.js";
import { rowsOf, shows } from "./rows.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../state/types.js").PulseColumns} PulseColumns */
/** @typedef {{left: number, right: number}} Plot  Plotting area in CSS pixels. */
/** @typedef {ReturnType<typeof import("./spans.js").createSpans>} Spans */
/** @typedef {{columns: PulseColumns, start: number, end: number, count: number, margin: number}} PulseReply  Columns of a range of cycles, with a margin at each side. */

/**
 * The current positions of the columns: one per device pixel; shifted or stretched if the visible time has changed since the
 * request.
 * @param {State} state @param {PulseReply} last @param {number} left @param {number} right  Device pixels. @returns {import("./paint.js").Picture}
 */
function placedColumns(state, { columns, start, end, count, margin }, left, right) {
  const window = shown(state);
  const pixels = (right - left) / (window.end - window.start);
  const same = end - start === window.end - window.start && count === right - left;
  const width = same ? 1 : ((end - start) / count) * pixels;
  const shift = (start - window.start) * pixels - margin * width;
  const first = left + (same ? Math.round(shift) : shift);
  const column = (/** @type {number} */ x) => Math.min(count + 2 * margin, Math.max(0, (x - first) / width));
  return { columns, from: Math.floor(column(left)), to: Math.ceil(column(right)), at: (i) => first + i * width };
}

/** @param {HTMLCanvasElement} canvas @param {State} state @param {Plot} plot @param {PulseReply} answer @param {Spans} spans */
export function paintRows(canvas, state, plot, answer, spans) {
  const { width, ratio: scale } = fit(canvas);
  const context = canvas.getContext("2d");
  if (!context) return;
  const left = Math.round(plot.left * scale);
  const right = Math.round(plot.right * scale);
  const picture = placedColumns(state, answer, left, right);
  const font = `${11 * scale}px ${getComputedStyle(document.body).fontFamily}`;
  const px = rowPx(state.panes.pulses);
  for (const [index, row] of rowsOf(state).entries()) {
    const top = Math.round((index * px + 4) * scale);
    const height = Math.round((px - 6) * scale);
    const selected = shows(row, state.row);
    if (selected) {
      context.fillStyle = color("--chosen");
      context.fillRect(0, top - 3 * scale, width * scale, px * scale);
    }
    context.fillStyle = color(selected ? "--ink" : "--quiet");
    context.textAlign = "right";
    context.textBaseline = "middle";
    context.font = `${selected ? "bold " : ""}${font}`;
    const isFoldable = "open" in row && row.open !== undefined;
    const name = ("short" in row && row.short) || row.name;
    context.fillText(fitting(context, name, left - (isFoldable ? 28 : 12) * scale), left - 8 * scale, top + height / 2);
    if (isFoldable) {
      context.textAlign = "left";
      context.fillText(row.open ? "▾" : "▸", 8 * scale, top + height / 2);
    }
    const place = { left, right, top, height, ratio: scale, ink: color(row.ink), font };
    context.save();
    context.beginPath();
    context.rect(left, 0, right - left, canvas.height);
    context.clip();
    if (row.kind === "folded") paintTint(context, picture, row.dir, true, { ...place, ink: color("--dir") });
    if ("bit" in row) paintSignal(context, picture, row.bit, place);
    else if ("wire" in row && spans.isDense(row)) paintTint(context, picture, row.line, false, place);
    else
      paintSpans(
        context,
        spans.spansOf(state, row).map((span) => placed(state, plot, span)),
        place,
      );
    context.restore();
  }
}

/** A name, shortened to fit. @param {CanvasRenderingContext2D} context @param {string} name @param {number} width  Device pixels. */
function fitting(context, name, width) {
  if (context.measureText(name).width <= width) return name;
  for (let length = name.length - 1; length > 1; length--) {
    const text = `${name.slice(0, length).trimEnd()}…`;
    if (context.measureText(text).width <= width) return text;
  }
  return name.slice(0, 1);
}

/** A span in device pixels. @param {State} state @param {Plot} plot @param {import("./spans.js").Span} span */
function placed(state, plot, { start, end, sample, ...rest }) {
  const x = (/** @type {number} */ cycle) => pixelOf(state, plot, cycle) * ratio();
  return { ...rest, from: x(start), to: x(end), sample: typeof sample === "number" ? x(sample + 0.5) : null };
}

/** Draws frames around the highlighted spans and the highlighted edge. @param {CanvasRenderingContext2D} context  In CSS pixels. @param {State} state @param {Plot} plot @param {Spans} spans */
export function drawHighlights(context, state, plot, spans) {
  const { highlighted } = state;
  if (!highlighted) return;
  context.setLineDash([]);
  context.strokeStyle = color("--ink");
  context.lineWidth = 1.5;
  const px = rowPx(state.panes.pulses);
  for (const [index, row] of rowsOf(state).entries()) {
    const top = index * px;
    if ("bit" in row) {
      if (highlighted.bit === null || !shows(row, highlighted.bit)) continue;
      context.strokeRect(pixelOf(state, plot, highlighted.start) - 3, top + 3, 6, px - 4);
    } else if (!spans.isDense(row)) {
      for (const { start, end, packet } of spans.spansOf(state, row)) {
        const isHighlighted = start === highlighted.start && end === highlighted.end;
        if (!isHighlighted && (packet === null || packet !== highlighted.packet || "wire" in row)) continue;
        const [from, to] = [
          Math.max(plot.left, pixelOf(state, plot, start)),
          Math.min(plot.right, pixelOf(state, plot, end)),
        ];
        if (to > from) context.strokeRect(from, top + 3, Math.max(2, to - from), px - 5);
      }
    }
  }
}
