/** Texts and widths of the columns of the packet table. */
import { count } from "../../state/number.js";

/** @typedef {import("../../state/types.js").PacketRow} PacketRow */
/** @typedef {{index: number, time: number, gap: number, outcome: number, bytes: number, meaning: number}} Widths  Widths of the widest texts, in CSS pixels. */

/** Minimum width of the bytes of frames, whose meaning needs the remaining width, in CSS pixels. */
const FRAME_BYTES_PX = 104;
/** Minimum widths of the bytes and of the outcome. */
const [MIN_BYTES_PX, MIN_OUTCOME_PX] = [80, 52];
/** Minimum widths of the meaning: while the bytes can be narrower, and afterwards. */
const [MEANING_PX, MIN_MEANING_PX] = [64, 30];
/** Text of each cell of a row, and its tooltip if it differs. @type {((row: PacketRow) => [string, string?])[]} */
export const COLUMNS = [
  ({ index }) => [count(index)],
  ({ start }) => [start],
  ({ hex }) => [hex],
  (row) => [meaningOf(row)],
  ({ short, outcome, why }) => [short, why ? `${outcome}: ${why}` : outcome],
  ({ gap }) => [gap || "–"],
];

/** The meaning of a row, with an arrow for its direction. @param {PacketRow} row */
export function meaningOf({ kind, fields }) {
  if (kind === "packet") return fields;
  const arrow = { frame: "→", reply: "←", collision: "↯" }[kind];
  return `${arrow} ${fields || kind}`;
}

/** Whether a row is highlighted. @param {PacketRow} row @param {import("../../state/types.js").State["highlighted"]} highlighted */
export function isHighlighted(row, highlighted) {
  if (!highlighted) return false;
  if (highlighted.packet !== null) return highlighted.packet === row.index;
  return highlighted.start < row.line_end_cycle && highlighted.end > row.start_cycle;
}

/**
 * Columns as wide as their texts; the meaning gets the remaining width. If the table is too narrow, the gap is hidden first (the
 * inspector shows it), then bytes and meaning become narrower, and last the outcome.
 * @param {Widths} widest @param {number} width  Of the table. @param {boolean} isFramed  Frames need more width for the meaning than for the bytes.
 */
export function columnWidths(widest, width, isFramed) {
  const available = width - widest.index - widest.time;
  const bytesAndMeaning = available - widest.gap - widest.outcome;
  const wanted = Math.min(
    widest.bytes,
    Math.max(isFramed ? bytesAndMeaning - widest.meaning : bytesAndMeaning / 2, FRAME_BYTES_PX),
  );
  const isTight = available < wanted + widest.outcome + widest.gap + MEANING_PX;
  const left = available - (isTight ? 0 : widest.gap);
  const bytes = Math.max(Math.min(MIN_BYTES_PX, wanted), Math.min(wanted, left - widest.outcome - MEANING_PX));
  const outcome = Math.min(widest.outcome, Math.max(MIN_OUTCOME_PX, left - bytes - MIN_MEANING_PX));
  return { isTight, bytes, outcome };
}
