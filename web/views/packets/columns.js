/** Texts and widths of the columns of the packet table. */
import { count } from "../../state/number.js";

/** @typedef {import("../../state/types.js").PacketRow} PacketRow */
/** @typedef {{index: number, time: number, gap: number, outcome: number, bytes: number, meaning: number}} Widths  Of the widest texts, in CSS pixels. */

/** Room for a few bytes: the most that they get of a frame whose words need the rest. */
const FEW_BYTES_PX = 104;
/** Of the columns of bytes and of the outcome there is always so much. */
const [MIN_BYTES_PX, MIN_OUTCOME_PX] = [80, 52];
/** Of the meaning there is so much while the bytes can give way, and then at least the other. */
const [MEANING_PX, MIN_MEANING_PX] = [64, 30];
/** Texts of a row's cells, each with its tooltip where that says more. @type {((row: PacketRow) => [string, string?])[]} */
export const COLUMNS = [
  ({ index }) => [count(index)],
  ({ start }) => [start],
  ({ hex }) => [hex],
  (row) => [meaningOf(row)],
  ({ short, outcome, why }) => [short, why ? `${outcome}: ${why}` : outcome],
  ({ gap }) => [gap || "–"],
];

/** The meaning of a row, and its direction. @param {PacketRow} row */
export function meaningOf({ kind, fields }) {
  if (kind === "packet") return fields;
  const arrow = { frame: "→", reply: "←", collision: "↯" }[kind];
  return `${arrow} ${fields || kind}`;
}

/** Whether a row is what a view points at. @param {PacketRow} row @param {import("../../state/types.js").State["highlighted"]} highlighted */
export function isHighlighted(row, highlighted) {
  if (!highlighted) return false;
  if (highlighted.packet !== null) return highlighted.packet === row.index;
  return highlighted.start < row.line_end_cycle && highlighted.end > row.start_cycle;
}

/**
 * Columns as wide as their texts; the meaning takes what is left. Where there is little room the gap goes first, which the
 * inspector shows, too; then bytes and meaning become narrow, and last the outcome.
 * @param {Widths} widest @param {number} room @param {boolean} isFramed  The meaning of a frame says more than its bytes, which get what it leaves.
 */
export function columnWidths(widest, room, isFramed) {
  const all = room - widest.index - widest.time;
  const both = all - widest.gap - widest.outcome;
  const wanted = Math.min(widest.bytes, Math.max(isFramed ? both - widest.meaning : both / 2, FEW_BYTES_PX));
  const tight = all < wanted + widest.outcome + widest.gap + MEANING_PX;
  const left = all - (tight ? 0 : widest.gap);
  const bytes = Math.max(Math.min(MIN_BYTES_PX, wanted), Math.min(wanted, left - widest.outcome - MEANING_PX));
  const outcome = Math.min(widest.outcome, Math.max(MIN_OUTCOME_PX, left - bytes - MIN_MEANING_PX));
  return { tight, bytes, outcome };
}
