/** Paints rows of the logic view. A column with both levels is a bar, so dense regions become blocks. */
import { color } from "../../time/plot.js";

/** @typedef {import("../../state/types.js").PulseColumns} PulseColumns */
/** @typedef {{columns: PulseColumns, from: number, to: number, at: (column: number) => number}} Picture  Columns `from` to `to` are visible; `at` is a column's left edge in device pixels. */

/** From this number of consecutive columns with both levels on, they are drawn as a block. */
const MIN_BLOCK = 4;
/** Bits of the line's signals (contract A3). */
const [RX, TX] = [33, 34];

/** Whether a signal was at a level in a column. @param {Uint32Array} words @param {number} column @param {number} bit */
export function has(words, column, bit) {
  return ((words[2 * column + (bit >> 5)] >>> (bit & 31)) & 1) === 1;
}

/** Draws each run of consecutive columns with a property. @param {Picture} picture @param {(column: number) => boolean} hasProperty @param {(x: number, width: number) => void} draw */
function runs({ from, to, at }, hasProperty, draw) {
  let begin = -1;
  for (let i = from; i <= to; i++) {
    const now = i < to && hasProperty(i);
    if (now && begin < 0) begin = i;
    if (now || begin < 0) continue;
    draw(at(begin), at(i) - at(begin));
    begin = -1;
  }
}

/**
 * @param {CanvasRenderingContext2D} context  In device pixels.
 * @param {Picture} picture
 * @param {number} bit
 * @param {{top: number, height: number, ratio: number, ink: string}} place  Device pixels.
 */
export function paintSignal(context, { columns, from, to, at }, bit, { top, height, ratio, ink }) {
  const thick = Math.max(1, Math.round(1.25 * ratio));
  /** @type {[number, number][]} */
  const blocks = [];
  context.fillStyle = ink;
  let begin = from;
  let kind = -1;
  /** @param {number} end */
  const close = (end) => {
    const [x, width] = [at(begin), at(end) - at(begin)];
    if (kind === 0) context.fillRect(x, top + height - thick, width, thick);
    else if (kind === 1) context.fillRect(x, top, width, thick);
    else if (kind === 2 && end - begin < MIN_BLOCK) context.fillRect(x, top, Math.max(width, thick), height);
    else if (kind === 2) blocks.push([x, width]);
    begin = end;
  };
  for (let i = from; i < to; i++) {
    const high = has(columns.high, i, bit);
    const low = has(columns.low, i, bit);
    const next = high && low ? 2 : high ? 1 : low ? 0 : -1;
    if (next === kind) continue;
    close(i);
    // Between columns of different levels there is an edge.
    if ((kind === 0 && next === 1) || (kind === 1 && next === 0)) context.fillRect(at(i), top, thick, height);
    kind = next;
  }
  close(to);
  context.globalAlpha = 0.62;
  for (const [x, width] of blocks) context.fillRect(x, top, width, height);
  context.globalAlpha = 1;
}

/**
 * A background for the columns in which a signal has a level: the direction of a folded channel, or bytes that are too dense to
 * draw.
 * @param {CanvasRenderingContext2D} context  In device pixels.
 * @param {Picture} picture
 * @param {number} bit
 * @param {boolean} high
 * @param {{top: number, height: number, ink: string}} place  Device pixels.
 */
export function paintTint(context, picture, bit, high, { top, height, ink }) {
  const words = high ? picture.columns.high : picture.columns.low;
  context.fillStyle = ink;
  context.globalAlpha = 0.22;
  runs(
    picture,
    (i) => has(words, i, bit),
    (x, width) => context.fillRect(x, top, width, height),
  );
  context.globalAlpha = 1;
}

/** Measured widths of texts, in device pixels. @type {Map<string, number>} */
const widths = new Map();
const MAX_WIDTHS = 5000;
let widthsFont = "";

/** @param {CanvasRenderingContext2D} context @param {string} text */
function widthOf(context, text) {
  if (widthsFont !== context.font || widths.size > MAX_WIDTHS) {
    widths.clear();
    widthsFont = context.font;
  }
  const width = widths.get(text) ?? context.measureText(text).width;
  widths.set(text, width);
  return width;
}

/**
 * Draws spans, each with the longest text that fits.
 * @param {CanvasRenderingContext2D} context  In device pixels.
 * @param {{from: number, to: number, texts: string[], marked: boolean, ink: string | null, sample?: number | null}[]} spans  In device pixels; `ink` is a special color.
 * @param {{top: number, height: number, ratio: number, ink: string, left: number, right: number, font: string}} place
 */
export function paintSpans(context, spans, { top, height, ratio, ink, left, right, font }) {
  context.font = font;
  context.textAlign = "center";
  context.textBaseline = "middle";
  const [plain, reverse] = [color("--ink"), color("--pane")];
  for (const { from, to, texts, marked, ink: own, sample } of spans) {
    const a = Math.max(left, from);
    const b = Math.min(right, Math.max(to, from + ratio));
    if (b <= a) continue;
    const width = Math.max(ratio, b - a - ratio);
    context.fillStyle = own ? color(own) : ink;
    context.globalAlpha = marked ? 0.75 : 0.28;
    context.fillRect(a, top, width, height);
    context.globalAlpha = 1;
    context.fillRect(a, top, Math.min(width, Math.max(1, Math.round(ratio))), height);
    if (typeof sample === "number" && sample >= left && sample <= right)
      context.fillRect(Math.round(sample - ratio), top + height - 3 * ratio, 2 * ratio, 3 * ratio);
    const text =
      width < 8 * ratio ? undefined : texts.find((candidate) => widthOf(context, candidate) < width - 4 * ratio);
    if (!text) continue;
    context.fillStyle = marked ? reverse : plain;
    context.fillText(text, (a + b) / 2, top + height / 2 + ratio * 0.5);
  }
}

/** The overview: strips that show in which columns STEP, DIR and the line change. @param {CanvasRenderingContext2D} context @param {PulseColumns} columns @param {{left: number, height: number}} place */
export function paintOverview(context, columns, { left, height }) {
  const picture = { columns, from: 0, to: columns.high.length / 2, at: (/** @type {number} */ i) => left + i };
  const strip = (
    /** @type {number} */ index,
    /** @type {string} */ ink,
    /** @type {(column: number) => boolean} */ hasProperty,
  ) => {
    context.fillStyle = color(ink);
    runs(picture, hasProperty, (x, width) => context.fillRect(x, (0.08 + index * 0.3) * height, width, 0.24 * height));
  };
  const busy = (/** @type {number} */ mask) => (/** @type {number} */ i) =>
    (columns.high[2 * i] & columns.low[2 * i] & mask) !== 0;
  strip(0, "--step", busy(0x0000ffff));
  strip(1, "--dir", busy(0xffff0000));
  strip(2, "--wire", (i) => has(columns.low, i, RX) || has(columns.low, i, TX));
}
