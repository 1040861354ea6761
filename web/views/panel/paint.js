/** Draws the rows of a panel over time: state, inputs and script. */
import { si } from "../../state/number.js";
import { color, font } from "../../time/plot.js";
import { POSITION, read, STATES, TRUST } from "./names.js";
import { lastUpTo } from "./story.js";
import { ROW_PX, TIME_PX } from "./strip_layout.js";

/** @typedef {{left: number, right: number}} Plot */
/** @typedef {{context: CanvasRenderingContext2D, plot: Plot, start: number, end: number, last: number}} Ground  The canvas and its visible time; `last` is the last cycle of the run. */

/** The color of each state. */
const INKS = [
  "--axis",
  "--axis",
  "--enable",
  "--step",
  "--dir",
  "--dir",
  "--step",
  "--dir",
  "--step",
  "--step",
  "--step",
  "--reply",
  "--reply",
  "--error",
  "--error",
];
const TRUST_INKS = ["--error", "--dir", "--enable"];

/** @typedef {typeof import("./strip_layout.js").BANDS[number]} Band */

/** @param {Ground} ground @param {number} cycle */
export const xOf = ({ plot, start, end }, cycle) =>
  plot.left + ((cycle - start) / (end - start)) * (plot.right - plot.left);

/** Text and color of a record in a band. @param {Band} band @param {number} word @returns {[text: string, ink: string]} */
function labelOf(band, word) {
  const { state, alarm, trust, group, loop } = read(word);
  if (band === "state") return [alarm ? `${state} ${alarm}` : state, INKS[STATES.indexOf(state)]];
  if (band === "position") return [state === "OFF" ? "" : (POSITION[trust] ?? trust), TRUST_INKS[TRUST.indexOf(trust)]];
  const shown = band === "group" ? group : loop;
  return [shown && state !== "EDIT" ? String(shown) : "", "--tick"];
}

/** @param {Ground} ground @param {Float64Array} records @param {Band} band @param {number} top */
export function paintBand(ground, records, band, top) {
  const { context, plot, start, end, last } = ground;
  const count = records.length / 4;
  let at = Math.max(0, lastUpTo(records, start, 4));
  let drawn = plot.left;
  while (at < count && records[4 * at] < end) {
    const [text, ink] = labelOf(band, records[4 * at + 1]);
    let next = at + 1;
    while (next < count && labelOf(band, records[4 * next + 1])[0] === text) next += 1;
    const until = next < count ? records[4 * next] : last;
    const left = Math.max(drawn, xOf(ground, records[4 * at]));
    const right = Math.min(plot.right, xOf(ground, until));
    // A record narrower than a pixel is drawn one pixel wide; further ones in that pixel are skipped.
    if (text && right >= drawn) {
      const wide = Math.max(1, right - left);
      context.globalAlpha = 0.22;
      context.fillStyle = color(ink);
      context.fillRect(left, top + 3, wide, ROW_PX - 6);
      context.globalAlpha = 1;
      context.fillRect(left, top + 3, 1, ROW_PX - 6);
      context.fillRect(left, top + ROW_PX - 4, wide, 1);
      label(context, text, left + 4, top, right - left - 6);
    }
    drawn = Math.max(drawn, Math.floor(right));
    at = next;
    if (drawn >= plot.right) break;
    // Skips all records within the same pixel.
    if (right - left < 1)
      at = Math.max(
        at,
        lastUpTo(records, start + ((drawn + 1 - plot.left) / (plot.right - plot.left)) * (end - start), 4),
      );
  }
}

/** Draws a text if there is room for it. @param {CanvasRenderingContext2D} context @param {string} text @param {number} x @param {number} top @param {number} room */
function label(context, text, x, top, room) {
  if (room < 10 || context.measureText(text).width > room) return;
  context.fillStyle = color("--ink");
  context.fillText(text, x, top + ROW_PX / 2);
}

/** The level of an input over time. @param {Ground} ground @param {{cycles: number[], levels: number[]} | undefined} changes @param {number} initial @param {number} top */
export function paintLevel(ground, changes, initial, top) {
  const { context, plot, start, end, last } = ground;
  const { cycles, levels } = changes ?? { cycles: [], levels: [] };
  let at = lastUpTo(cycles, start);
  let level = at < 0 ? initial : levels[at];
  let x = plot.left;
  const y = (/** @type {number} */ high) => top + (high ? 5 : ROW_PX - 5) + 0.5;
  context.strokeStyle = color("--wire");
  context.fillStyle = color("--wire");
  context.lineWidth = 1.25;
  context.beginPath();
  context.moveTo(x, y(level));
  const to = (/** @type {number} */ right) => {
    context.lineTo(right, y(level));
    if (level) {
      context.globalAlpha = 0.18;
      context.fillRect(x, top + 5, right - x, ROW_PX - 10);
      context.globalAlpha = 1;
    }
  };
  for (at += 1; at < cycles.length && cycles[at] <= end; at += 1) {
    const next = Math.max(x, xOf(ground, cycles[at]));
    to(next);
    level = levels[at];
    context.lineTo(next, y(level));
    x = next;
  }
  to(Math.max(x, Math.min(plot.right, xOf(ground, last))));
  context.stroke();
}

/** An entry of the script as a diamond, which can be dragged. @param {CanvasRenderingContext2D} context @param {number} x @param {number} top @param {boolean} selected */
export function paintEntry(context, x, top, selected) {
  const [y, reach] = [top + ROW_PX / 2, selected ? 6 : 4];
  context.beginPath();
  context.moveTo(x - reach, y);
  context.lineTo(x, y - reach);
  context.lineTo(x + reach, y);
  context.lineTo(x, y + reach);
  context.closePath();
  context.fillStyle = color(selected ? "--accent" : "--pane");
  context.fill();
  context.strokeStyle = color(selected ? "--ink" : "--wire");
  context.lineWidth = 1.5;
  context.stroke();
}

/** A press that had no effect. @param {CanvasRenderingContext2D} context @param {number} x @param {number} top */
export function paintIgnored(context, x, top) {
  const y = top + 6;
  context.strokeStyle = color("--error");
  context.lineWidth = 1.5;
  context.beginPath();
  for (const side of [-1, 1]) {
    context.moveTo(x - 3, y - 3 * side);
    context.lineTo(x + 3, y + 3 * side);
  }
  context.stroke();
}

/** The name of a row, left of the plotting area. @param {CanvasRenderingContext2D} context @param {string} name @param {number} right @param {number} top @param {boolean} selected */
export function paintName(context, name, right, top, selected) {
  context.font = `${selected ? "bold " : ""}11px ${font()}`;
  context.textAlign = "right";
  context.fillStyle = color(selected ? "--ink" : "--quiet");
  context.fillText(name, right - 6, top + ROW_PX / 2, right - 8);
  context.textAlign = "left";
  context.font = `11px ${font()}`;
}

/** @typedef {{start: number, end: number, min: Float64Array, max: Float64Array}} Curve  Positions in columns, in steps, and their range of cycles. */

/** The position over time, with its minimum and maximum. @param {Ground} ground @param {Curve} curve @param {number} height @param {(steps: number) => string} print */
export function paintCurve(ground, curve, height, print) {
  const { context, plot } = ground;
  let [low, high] = [Infinity, -Infinity];
  for (const value of curve.min) low = Math.min(low, value);
  for (const value of curve.max) high = Math.max(high, value);
  if (low > high) return;
  // Leaves space for the caption above.
  const [top, bottom] = [18, height - 8];
  const y = (/** @type {number} */ value) =>
    high > low ? bottom - ((value - low) / (high - low)) * (bottom - top) : bottom;
  const column = (curve.end - curve.start) / curve.min.length;
  context.save();
  context.beginPath();
  context.rect(plot.left, 0, plot.right - plot.left, height);
  context.clip();
  context.strokeStyle = color("--actual");
  context.lineWidth = 1.6;
  context.beginPath();
  for (let at = 0; at < curve.min.length; at += 1) {
    const x = xOf(ground, curve.start + (at + 0.5) * column);
    if (at === 0) context.moveTo(x, y(curve.min[at]));
    // The nearer end first, so that the line passes each column once.
    const rises = at === 0 || curve.max[at] >= curve.max[at - 1];
    context.lineTo(x, y(rises ? curve.min[at] : curve.max[at]));
    context.lineTo(x, y(rises ? curve.max[at] : curve.min[at]));
  }
  context.stroke();
  context.restore();
  context.fillStyle = color("--quiet");
  context.fillText("travel, units", plot.left + 4, 6);
  for (const value of new Set([low, high])) paintName(context, print(value), plot.left, y(value) - ROW_PX / 2, false);
}

/** Round times below the rows. @param {Ground} ground @param {number} clock @param {number} top @param {number} bottom */
export function paintTime(ground, clock, top, bottom) {
  const { context, plot, start, end } = ground;
  const maxLabels = Math.max(2, Math.floor((plot.right - plot.left) / 90));
  const minStep = (end - start) / clock / maxLabels;
  const power = 10 ** Math.floor(Math.log10(minStep));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((each) => each >= minStep) ?? minStep;
  context.textAlign = "center";
  for (let number = Math.ceil(start / clock / step); number * step * clock <= end; number += 1) {
    const x = xOf(ground, number * step * clock);
    context.fillStyle = color("--grid");
    context.fillRect(Math.round(x), top, 1, bottom - top);
    context.fillStyle = color("--quiet");
    context.fillText(si(number * step, "s", 6), x, bottom + TIME_PX / 2);
  }
  context.textAlign = "left";
}
