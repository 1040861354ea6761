/**
 * The rows of the logic view: which there are, which are on show. The line comes first, so that it is in view
 * beside the first channels; a channel is DIR and STEP, or both in one row when it is folded.
 */
import { lookedAt } from "../../state/state.js";

/** @typedef {import("../../state/types.js").State} State */
/**
 * @typedef {{kind: "signal", name: string, bit: number, ink: string, channel?: number}} SignalRow
 * @typedef {{kind: "folded", name: string, bit: number, dir: number, ink: string, channel: number}} FoldedRow  STEP over its DIR.
 * @typedef {{kind: "packets" | "replies" | "ticks" | "violations", name: string, ink: string}} SpanRow
 * @typedef {SignalRow | FoldedRow | SpanRow} Row
 */

/** Height of a row in CSS pixels. */
export const ROW_PX = 19;
/** Signal bits (contract A3). */
const [DIR, EN, RX, TX, DE] = [16, 32, 33, 34, 35];
/** With more channels than these, all begin folded. */
const MOST_UNFOLDED = 4;

/** The line's signals that a run may leave as they are. @type {SignalRow[]} */
const REPLY = [{ kind: "signal", name: "TX", bit: TX, ink: "--wire" }, { kind: "signal", name: "DE", bit: DE, ink: "--wire" }];

/** @param {State} state */
function channelsOf(state) {
  return lookedAt(state)?.channels ?? 1;
}

/** @param {State} state @param {number} channel */
export function isFolded(state, channel) {
  return state.folds[channel] ?? channelsOf(state) > MOST_UNFOLDED;
}

/** Whether every channel is folded. @param {State} state */
export function allFolded(state) {
  return Array.from({ length: channelsOf(state) }, (_, channel) => channel).every((channel) => isFolded(state, channel));
}

/** The channel that a signal belongs to; none for the line's and EN. @param {number} bit */
export function channelOf(bit) {
  return bit < EN ? bit % DIR : null;
}

/** Signals that never change in this run and are not asked for. @param {State} state */
export function idle(state) {
  const changing = lookedAt(state)?.changing ?? [];
  return REPLY.filter(({ bit }) => !changing.includes(bit));
}

/** The rows on show. @param {State} state @returns {Row[]} */
export function rowsOf(state) {
  const away = state.allSignals ? [] : idle(state).filter(({ bit }) => bit !== state.row);
  /** @type {Row[]} */
  const rows = [{ kind: "signal", name: "EN", bit: EN, ink: "--enable" }, { kind: "signal", name: "RX", bit: RX, ink: "--wire" },
    { kind: "packets", name: state.result?.summary.framed ? "frames" : "packets", ink: "--packet" }, ...REPLY.filter((row) => !away.includes(row))];
  if (state.result?.summary.framed) rows.push({ kind: "replies", name: "replies", ink: "--reply" });
  rows.push({ kind: "ticks", name: "ticks", ink: "--tick" });
  if (lookedAt(state)?.violations) rows.push({ kind: "violations", name: "timing", ink: "--error" });
  for (let channel = 0; channel < channelsOf(state); channel++) {
    if (isFolded(state, channel)) rows.push({ kind: "folded", name: `ch ${channel}`, bit: channel, dir: DIR + channel, ink: "--step", channel });
    else {
      rows.push({ kind: "signal", name: `DIR ${channel}`, bit: DIR + channel, ink: "--dir", channel },
        { kind: "signal", name: `STEP ${channel}`, bit: channel, ink: "--step", channel });
    }
  }
  return rows;
}

/** Every signal that there is, on show or not. @param {State} state @returns {{name: string, bit: number}[]} */
export function signalsOf(state) {
  const channels = Array.from({ length: channelsOf(state) }, (_, i) => [{ name: `DIR ${i}`, bit: DIR + i }, { name: `STEP ${i}`, bit: i }]);
  return [{ name: "EN", bit: EN }, { name: "RX", bit: RX }, ...REPLY.map(({ name, bit }) => ({ name, bit })), ...channels.flat()];
}

/** Whether a row shows a signal. @param {Row} row @param {number} bit */
export function shows(row, bit) {
  return (row.kind === "signal" && row.bit === bit) || (row.kind === "folded" && (row.bit === bit || row.dir === bit));
}
