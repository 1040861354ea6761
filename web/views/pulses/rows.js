/** The rows of the logic view, in groups that the user orders, hides and names. */

import { selected } from "../../state/queries.js";
import { inOrder } from "../../state/row_choices.js";

/** @typedef {import("../../state/types.js").State} State */
/**
 * @typedef {{kind: "signal", name: string, bit: number, ink: string, short?: string, channel?: number, open?: boolean}} SignalRow  With `open` it has a button to fold its `channel`. `short` is a name for the gutter.
 * @typedef {{kind: "folded", name: string, bit: number, dir: number, ink: string, channel: number, open: false}} FoldedRow  STEP with its DIR as background.
 * @typedef {{kind: "packets" | "replies" | "ticks" | "violations", name: string, ink: string}} SpanRow
 * @typedef {{kind: "bits" | "bytes" | "fields", wire: "rx" | "tx", line: number, name: string, ink: string}} LineRow  A decoder of the signal with bit `line`.
 * @typedef {SignalRow | FoldedRow | SpanRow | LineRow} Row
 * @typedef {{group: string, own: string, rows: Row[]}} Group  A group of rows with the user's names; `own` is its default name.
 */

/** Signal bits (contract A3). */
const [DIR, EN, RX, TX, DE] = [16, 32, 33, 34, 35];
/** With more channels than this, all are folded at first. */
const MAX_UNFOLDED = 4;

/** Signals of the line, which may never change in a run. */
const LINE = [
  { name: "RX", bit: RX },
  { name: "TX", bit: TX },
  { name: "DE", bit: DE },
];

/** @param {State} state */
function channelsOf(state) {
  return selected(state)?.channels ?? 1;
}

/** Whether a channel is folded to one row, or the decoders of RX or TX are hidden. @param {State} state @param {number} channel */
export function isFolded(state, channel) {
  return state.folds[channel] ?? (channel === RX || channel === TX || channelsOf(state) > MAX_UNFOLDED);
}

/** Whether every channel is folded. @param {State} state */
export function allFolded(state) {
  return Array.from({ length: channelsOf(state) }, (_, channel) => channel).every((channel) =>
    isFolded(state, channel),
  );
}

/** The channel of a signal that can be folded; for RX and TX their bit; null for EN and DE. @param {number} bit */
export function channelOf(bit) {
  return bit < EN ? bit % DIR : bit === RX || bit === TX ? bit : null;
}

/** Signals of the line that never change in this run. @param {State} state */
export function idleSignals(state) {
  const changing = selected(state)?.changing ?? [];
  return LINE.filter(({ bit }) => !changing.includes(bit));
}

/** Whether anything is on the line. @param {State} state */
export function hasLine(state) {
  return selected(state)?.changing.includes(RX) ?? false;
}

/** The user's name of a group, or its default name. @param {State} state @param {string} group @param {string} own */
export function groupName(state, group, own) {
  return state.panes.pulses.names[group] ?? own;
}

/** A signal of the line with its decoders. @param {State} state @param {{name: string, bit: number}} signal @returns {Row[]} */
function lineRows(state, { name: own, bit }) {
  const name = groupName(state, own, own);
  const isIdle = !selected(state)?.changing.includes(bit);
  if (bit === DE || isIdle) return [{ kind: "signal", name, bit, ink: "--wire" }];
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

/** All groups of the run in the user's order, including hidden ones. @param {State} state @returns {Group[]} */
export function groupsOf(state) {
  const hiddenSignals = state.allSignals ? [] : idleSignals(state).filter(({ bit }) => bit !== state.row);
  const framed = state.result?.summary.framed ?? false;
  /** @type {Group[]} */
  const groups = [];
  /** @param {string} own @param {(name: string) => Row[]} rows @param {string} [group] */
  const add = (own, rows, group = own) => groups.push({ group, own, rows: rows(groupName(state, group, own)) });
  add("EN", (name) => [{ kind: "signal", name, bit: EN, ink: "--enable" }]);
  for (const signal of LINE) {
    if (!hiddenSignals.includes(signal)) add(signal.name, () => lineRows(state, signal));
    if (signal.bit === RX && hasLine(state))
      add(framed ? "frames" : "packets", (name) => [{ kind: "packets", name, ink: "--packet" }], "packets");
    if (signal.bit === TX && framed) add("replies", (name) => [{ kind: "replies", name, ink: "--reply" }]);
  }
  if (hasLine(state) || selected(state)?.ticks_done) add("ticks", (name) => [{ kind: "ticks", name, ink: "--tick" }]);
  if (selected(state)?.violations) add("timing", (name) => [{ kind: "violations", name, ink: "--error" }]);
  for (let channel = 0; channel < channelsOf(state); channel++)
    add(`ch ${channel}`, () => channelRows(state, channel), `${channel}`);
  return inOrder(state.panes.pulses, groups, ({ group }) => group);
}

/** @param {State} state @param {number} channel @returns {Row[]} */
function channelRows(state, channel) {
  const [dir, step] = signalsOfChannel(state, channel);
  const { [channel]: userName } = state.panes.pulses.names;
  return isFolded(state, channel)
    ? [
        {
          kind: "folded",
          name: groupName(state, `${channel}`, `ch ${channel}`),
          bit: channel,
          dir: DIR + channel,
          ink: "--step",
          channel,
          open: false,
        },
      ]
    : [
        { kind: "signal", ...dir, short: userName && "DIR", ink: "--dir", channel, open: true },
        { kind: "signal", ...step, short: userName, ink: "--step", channel },
      ];
}

/** The visible groups: all that are not hidden, and the selected signal's group. @param {State} state */
export function shownGroups(state) {
  const { hidden } = state.panes.pulses;
  return groupsOf(state).filter(
    ({ group, rows }) => !hidden.includes(group) || rows.some((row) => shows(row, state.row)),
  );
}

/** The visible rows. @param {State} state @returns {Row[]} */
export function rowsOf(state) {
  return shownGroups(state).flatMap(({ rows }) => rows);
}

/** @param {State} state @param {number} channel */
function signalsOfChannel(state, channel) {
  const name = groupName(state, `${channel}`, `${channel}`);
  return [
    { name: `DIR ${name}`, bit: DIR + channel },
    { name: `STEP ${name}`, bit: channel },
  ];
}

/** All signals, visible or not. @param {State} state @returns {{name: string, bit: number}[]} */
export function signalsOf(state) {
  const line = [{ name: "EN", bit: EN }, ...LINE].map(({ name, bit }) => ({ name: groupName(state, name, name), bit }));
  const channels = Array.from({ length: channelsOf(state) }, (_, channel) => signalsOfChannel(state, channel));
  return [...line, ...channels.flat()];
}

/** The name of a signal. @param {State} state @param {number} bit */
export function nameOf(state, bit) {
  return signalsOf(state).find((signal) => signal.bit === bit)?.name ?? "";
}

/** Whether a row shows a signal. @param {Row} row @param {number} bit */
export function shows(row, bit) {
  return (row.kind === "signal" && row.bit === bit) || (row.kind === "folded" && (row.bit === bit || row.dir === bit));
}
