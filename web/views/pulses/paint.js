/**
 * Paints the logic view's rows on a 2D context, in few paths: a column in which a signal was high and low is
 * a bar from top to bottom, so one edge is a line and a region too dense to draw is a filled block.
 */
import { color } from "../../time/plot.js";

/** @typedef {import("../../state/types.js").PulseColumns} PulseColumns */

/** Consecutive busy columns from which on they count as a block. */
const BLOCK = 4;
/** Bits of the line's signals (contract A3). */
const [RX, TX] = [33, 34];

/** Whether a signal was at a level in a column. @param {Uint32Array} words @param {number} column @param {number} bit */
export function has(words, column, bit) {
  return ((words[2 * column + (bit >> 5)] >>> (bit & 31)) & 1) === 1;
}

/**
 * @param {CanvasRenderingContext2D} context  In device pixels.
 * @param {PulseColumns} columns
 * @param {number} bit
 * @param {{left: number, top: number, height: number, ratio: number, ink: string}} place  Device pixels.
 */
export function paintSignal(context, columns, bit, { left, top, height, ratio, ink }) {
  const total = columns.high.length / 2;
  const thick = Math.max(1, Math.round(1.25 * ratio));
  const steady = new Path2D();
  const bars = new Path2D();
  const blocks = new Path2D();
  let begin = 0;
  let kind = -1;
  /** @param {number} end */
  const close = (end) => {
    const width = end - begin;
    if (kind === 0) steady.rect(left + begin, top + height - thick, width, thick);
    else if (kind === 1) steady.rect(left + begin, top, width, thick);
    else if (kind === 2 && width < BLOCK) bars.rect(left + begin, top, Math.max(width, thick), height);
    else if (kind === 2) blocks.rect(left + begin, top, width, height);
    begin = end;
  };
  for (let i = 0; i < total; i++) {
    const high = has(columns.high, i, bit);
    const low = has(columns.low, i, bit);
    const next = high && low ? 2 : high ? 1 : low ? 0 : -1;
    // Two neighbours that stand at different levels have an edge between them.
    if (next !== kind) {
      if (i > 0) close(i);
      if ((kind === 0 && next === 1) || (kind === 1 && next === 0)) bars.rect(left + i, top, thick, height);
      kind = next;
    }
  }
  close(total);
  context.fillStyle = ink;
  context.fill(steady);
  context.fill(bars);
  context.globalAlpha = 0.62;
  context.fill(blocks);
  context.globalAlpha = 1;
}

/**
 * A ground behind the columns in which a signal is high: the direction under the steps of a folded channel.
 * @param {CanvasRenderingContext2D} context  In device pixels.
 * @param {PulseColumns} columns
 * @param {number} bit
 * @param {{left: number, top: number, height: number, ink: string}} place  Device pixels.
 */
export function paintTint(context, columns, bit, { left, top, height, ink }) {
  const path = new Path2D();
  const total = columns.high.length / 2;
  for (let i = 0; i < total; i++) if (has(columns.high, i, bit)) path.rect(left + i, top, 1, height);
  context.fillStyle = ink;
  context.globalAlpha = 0.22;
  context.fill(path);
  context.globalAlpha = 1;
}

/**
 * Spans with a text in them, as a decoder shows them: the longest text that fits.
 * @param {CanvasRenderingContext2D} context  In device pixels.
 * @param {{from: number, to: number, texts: string[], marked: boolean, ink: string | null}[]} spans  Device pixels; an ink of their own where they are not as usual.
 * @param {{top: number, height: number, ratio: number, ink: string, left: number, right: number}} place
 */
export function paintSpans(context, spans, { top, height, ratio, ink, left, right }) {
  context.font = `${11 * ratio}px ${getComputedStyle(document.body).fontFamily}`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (const { from, to, texts, marked, ink: own } of spans) {
    const a = Math.max(left, from);
    const b = Math.min(right, Math.max(to, from + ratio));
    if (b <= a) continue;
    const width = Math.max(ratio, b - a - ratio);
    context.fillStyle = own ? color(own) : ink;
    context.globalAlpha = marked ? 0.75 : 0.28;
    context.fillRect(a, top, width, height);
    context.globalAlpha = 1;
    context.fillRect(a, top, Math.min(width, Math.max(1, Math.round(ratio))), height);
    const text = texts.find((candidate) => context.measureText(candidate).width < width - 6 * ratio);
    if (!text) continue;
    context.fillStyle = color(marked ? "--pane" : "--ink");
    context.fillText(text, (a + b) / 2, top + height / 2 + ratio * 0.5);
  }
}

/** One thin strip: how busy each column of the whole run is. @param {CanvasRenderingContext2D} context @param {PulseColumns} columns @param {{left: number, height: number}} place */
export function paintOverview(context, columns, { left, height }) {
  const total = columns.high.length / 2;
  const lanes = [{ mask: 0x0000ffff, ink: "--step" }, { mask: 0xffff0000, ink: "--dir" }];
  for (const [lane, { mask, ink }] of lanes.entries()) {
    const path = new Path2D();
    for (let i = 0; i < total; i++) {
      const busy = columns.high[2 * i] & columns.low[2 * i] & mask;
      if (busy !== 0) path.rect(left + i, (0.08 + lane * 0.3) * height, 1, 0.24 * height);
    }
    context.fillStyle = color(ink);
    context.fill(path);
  }
  const wire = new Path2D();
  for (let i = 0; i < total; i++) if (has(columns.low, i, RX) || has(columns.low, i, TX)) wire.rect(left + i, 0.68 * height, 1, 0.24 * height);
  context.fillStyle = color("--wire");
  context.fill(wire);
}
