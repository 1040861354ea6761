/**
 * The rows of the logic view: which there are, which are on show. The line comes first, so that it is in view
 * beside the first channels; a channel is DIR and STEP, or both in one row when it is folded. Under RX and TX
 * stand their decoders, until they are folded.
 */
import { selected } from "../../state/state.js";

/** @typedef {import("../../state/types.js").State} State */
/**
 * @typedef {{kind: "signal", name: string, bit: number, ink: string, channel?: number, open?: boolean}} SignalRow  With the sign that folds its `channel` where it has `open`.
 * @typedef {{kind: "folded", name: string, bit: number, dir: number, ink: string, channel: number, open: false}} FoldedRow  STEP over its DIR.
 * @typedef {{kind: "packets" | "replies" | "ticks" | "violations", name: string, ink: string}} SpanRow
 * @typedef {{kind: "bits" | "bytes" | "fields", wire: "rx" | "tx", line: number, name: string, ink: string}} LineRow  A decoder of the signal `line`.
 * @typedef {SignalRow | FoldedRow | SpanRow | LineRow} Row
 */

/** Height of a row in CSS pixels. */
export const ROW_PX = 19;
/** Signal bits (contract A3). */
const [DIR, EN, RX, TX, DE] = [16, 32, 33, 34, 35];
/** With more channels than these, all begin folded. The decoders do so too: the curves need the room. */
const MAX_UNFOLDED = 4;

/** Signals of the line, that a run may leave as they are. */
const LINE = [
  { name: "RX", bit: RX },
  { name: "TX", bit: TX },
  { name: "DE", bit: DE },
];

/** @param {State} state */
function channelsOf(state) {
  return selected(state)?.channels ?? 1;
}

/** Whether a channel is one row, or the decoders of RX or TX are put away. @param {State} state @param {number} channel */
export function isFolded(state, channel) {
  return state.folds[channel] ?? (channel === RX || channel === TX || channelsOf(state) > MAX_UNFOLDED);
}

/** Whether every channel is folded. @param {State} state */
export function allFolded(state) {
  return Array.from({ length: channelsOf(state) }, (_, channel) => channel).every((channel) =>
    isFolded(state, channel),
  );
}

/** What folds with a signal: its channel, or itself for RX and TX; nothing for EN and DE. @param {number} bit */
export function channelOf(bit) {
  return bit < EN ? bit % DIR : bit === RX || bit === TX ? bit : null;
}

/** Signals that never change in this run and are not asked for. @param {State} state */
export function idle(state) {
  const changing = selected(state)?.changing ?? [];
  return LINE.filter(({ bit }) => !changing.includes(bit));
}

/** Whether anything is on the line. @param {State} state */
export function hasLine(state) {
  return selected(state)?.changing.includes(RX) ?? false;
}

/** A signal of the line with its decoders. @param {State} state @param {{name: string, bit: number}} signal @returns {Row[]} */
function lineRows(state, { name, bit }) {
  const quiet = !selected(state)?.changing.includes(bit);
  if (bit === DE || quiet) return [{ kind: "signal", name, bit, ink: "--wire" }];
  const open = !isFolded(state, bit);
  /** @type {Row} */
  const row = { kind: "signal", name, bit, ink: "--wire", channel: bit, open };
  const wire = bit === RX ? "rx" : "tx";
  /** @type {("bits" | "bytes" | "fields")[]} */
  const kinds = open ? ["bits", "bytes", "fields"] : [];
  return [
    row,
    ...kinds.map(
      (kind) =>
        /** @type {const} */ ({ kind, wire, line: bit, name: kind, ink: wire === "rx" ? "--packet" : "--reply" }),
    ),
  ];
}

/** The rows on show. @param {State} state @returns {Row[]} */
export function rowsOf(state) {
  const away = state.allSignals
    ? []
    : idle(state)
        .filter(({ bit }) => bit !== state.row)
        .map(({ bit }) => bit);
  const framed = state.result?.summary.framed ?? false;
  /** @type {Row[]} */
  const rows = [{ kind: "signal", name: "EN", bit: EN, ink: "--enable" }];
  for (const signal of LINE) {
    if (!away.includes(signal.bit)) rows.push(...lineRows(state, signal));
    if (signal.bit === RX && hasLine(state))
      rows.push({ kind: "packets", name: framed ? "frames" : "packets", ink: "--packet" });
    if (signal.bit === TX && framed) rows.push({ kind: "replies", name: "replies", ink: "--reply" });
  }
  if (hasLine(state) || selected(state)?.ticks_done) rows.push({ kind: "ticks", name: "ticks", ink: "--tick" });
  if (selected(state)?.violations) rows.push({ kind: "violations", name: "timing", ink: "--error" });
  for (let channel = 0; channel < channelsOf(state); channel++) {
    if (isFolded(state, channel))
      rows.push({
        kind: "folded",
        name: `ch ${channel}`,
        bit: channel,
        dir: DIR + channel,
        ink: "--step",
        channel,
        open: false,
      });
    else {
      rows.push(
        { kind: "signal", name: `DIR ${channel}`, bit: DIR + channel, ink: "--dir", channel, open: true },
        { kind: "signal", name: `STEP ${channel}`, bit: channel, ink: "--step", channel },
      );
    }
  }
  return rows;
}

/** Every signal that there is, on show or not. @param {State} state @returns {{name: string, bit: number}[]} */
export function signalsOf(state) {
  const channels = Array.from({ length: channelsOf(state) }, (_, i) => [
    { name: `DIR ${i}`, bit: DIR + i },
    { name: `STEP ${i}`, bit: i },
  ]);
  return [{ name: "EN", bit: EN }, ...LINE, ...channels.flat()];
}

/** What a signal is called. @param {State} state @param {number} bit */
export function nameOf(state, bit) {
  return signalsOf(state).find((signal) => signal.bit === bit)?.name ?? "";
}

/** Whether a row shows a signal. @param {Row} row @param {number} bit */
export function shows(row, bit) {
  return (row.kind === "signal" && row.bit === bit) || (row.kind === "folded" && (row.bit === bit || row.dir === bit));
}
