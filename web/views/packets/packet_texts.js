/** Texts of the inspector about a packet. */
import { count, time } from "../../state/number.js";

/** @typedef {import("../../state/types.js").PacketDetail} PacketDetail */

/** Maximum bytes whose hex and bits are written. */
const MAX_BYTES = 4;

/** A range of bytes as text: hex, bits and time on the line. Without a range (`first` below 0) the time of the whole row. @param {PacketDetail} row @param {number} first @param {number} last @param {number} clock */
export function rangeText(row, first, last, clock) {
  if (first < 0) return `on the line ${time(row.start_cycle / clock)} to ${time(row.line_end_cycle / clock)}`;
  const hex = row.hex.split(" ").slice(first, last + 1);
  const bits = hex
    .map((byte) => Number.parseInt(byte, 16).toString(2).padStart(8, "0"))
    .map((eight) => `${eight.slice(0, 4)}\u2009${eight.slice(4)}`);
  const explained = row.layout.filter(({ from, until }) => from <= first && last < until).map(bitsText);
  const when = `${time(row.byte_cycles[first] / clock)} to ${time((row.byte_cycles[last] + row.byte_length) / clock)}`;
  return [
    first === last ? `byte ${first}` : `bytes ${first} to ${last}`,
    hex.length <= MAX_BYTES ? hex.join(" ") : "",
    explained.find(Boolean) ?? (hex.length <= MAX_BYTES ? `bits ${bits.join(" ")}` : ""),
    when,
  ]
    .filter(Boolean)
    .join(" · ");
}

/** The number of bits and their meaning: `bits 6–0 = 0000101: 5 steps`. @param {import("../../state/types.js").BitGroup} group */
export function bitText({ high, low, levels, name, value }) {
  const bits = high === low ? `bit ${high}` : `bits ${high}–${low}`;
  return `${bits} = ${levels}: ${name} ${value}`;
}

/** The meaning of all bits of a field; empty for a plain number. @param {import("../../state/types.js").PacketField} field */
export const bitsText = ({ bits }) => bits.map(bitText).join(", ");

/** @typedef {[name: string, value: string, isBad?: boolean]} Fact */
/** The facts of a row: times, size and CRC. @param {PacketDetail} row @param {(cycles: number) => string} timeOf @returns {Fact[]} */
export function factsOf(row, timeOf) {
  const { check, check_found: found, check_expected: expected } = row;
  const framing = row.layout.filter(({ name }) => ["COBS", "delimiter"].includes(name)).length;
  const size = row.byte_cycles.length;
  /** @type {Fact} */
  const checkFact =
    check === "holds"
      ? ["CRC-32/ISCSI", `${found} ✓`]
      : check === "fails"
        ? ["CRC-32/ISCSI", `✕ ${found}, expected ${expected}`, true]
        : check === "none"
          ? ["CRC", "none: raw packets have no CRC"]
          : ["CRC", "none: incomplete frame"];
  const tick =
    row.tick_start_cycle === null
      ? []
      : [
          [
            "tick",
            `${timeOf(row.tick_start_cycle)}${row.tick_end_cycle === null ? ", not ended" : ` to ${timeOf(row.tick_end_cycle)}`}`,
          ],
        ];
  const turnaround =
    row.turnaround_cycles === null
      ? []
      : [
          [
            "turnaround",
            `${timeOf(row.turnaround_cycles)} after the end of #${count(row.answers ?? 0)}${row.drive_cycles === null ? "" : `; DE rises after ${timeOf(row.drive_cycles)}`}`,
          ],
        ];
  const all = [
    ["gap before", row.gap_cycles === null ? "–" : timeOf(row.gap_cycles)],
    ...turnaround,
    ...tick,
    ...(row.kind === "collision"
      ? []
      : [
          ["size", `${count(size)} ${size === 1 ? "byte" : "bytes"}${framing ? `, ${framing} of them COBS` : ""}`],
          checkFact,
        ]),
  ];
  return /** @type {Fact[]} */ (all);
}
