/** The options of the dialog of a recording, and their request. */

/** @typedef {import("../../engine/capture.js").Facts} Facts */
/** @typedef {import("../../engine/capture.js").OpenRequest} Request */
/** @typedef {{map: string, clock: number, rate: number, baud: number, uart: string, from_s: number | null, to_s: number | null}} Values  Of the fields; 0 and "" if empty. */
/** @typedef {{hasLine: boolean, hasPlan: boolean, isPart: boolean, choosesPart: boolean, isCompared: boolean}} Situation  `hasPlan`: a run can be the baseline. */

/** Formats of a serial line: data bits, parity, stop bits. @type {[string, string][]} */
export const FORMATS = [
  ["8N1", "8N1 (usual)"],
  ["8E1", "8E1, even parity"],
  ["8O1", "8O1, odd parity"],
  ["8N2", "8N2, 2 stop bits"],
  ["7N1", "7N1, 7 data bits"],
  ["7E1", "7E1, even parity"],
  ["7O1", "7O1, odd parity"],
  ["7N2", "7N2, 2 stop bits"],
  ["8E2", "8E2"],
  ["8O2", "8O2"],
  ["7E2", "7E2"],
  ["7O2", "7O2"],
];

/** Number bases of written bytes, as for the option `--base` of the command. @type {[string, string][]} */
export const BASES = [
  ["", "detected from the digits"],
  ["hex", "hexadecimal"],
  ["dec", "decimal"],
  ["oct", "octal"],
  ["bin", "binary"],
];

/** Whether channels are mapped to signals: for levels, and for decoded bytes of several lines. @param {Facts} facts */
export const hasMap = ({ has_levels, channels }) => has_levels || channels.length > 1;

/** Whether the sample rate is required. It is not for bytes: without times they follow each other at the bit rate. @param {Facts} facts */
export const needsRate = ({ has_times, has_bytes }) => !has_times && !has_bytes;

/** The placeholder of the bit rate. @param {Facts} facts */
export const emptyBaud = ({ has_times, has_bytes }) => (has_times || !has_bytes ? "measured" : "required");

/** The visible fields. Only a whole recording can be compared with a run. @param {Facts} facts @param {Situation} situation */
export function shownFields({ has_levels, has_bytes }, { hasLine, hasPlan, isPart, choosesPart, isCompared }) {
  const compare = hasPlan && !isPart;
  return {
    part: isPart || choosesPart,
    choosePart: !isPart && !choosesPart,
    compare,
    align: compare && isCompared,
    baud: has_levels ? hasLine : has_bytes,
    uart: has_levels && hasLine,
  };
}

/** The request of the visible fields. @param {Values} values @param {{map: boolean, rate: boolean, baud: boolean, uart: boolean}} shown @returns {Request} */
export function requestOf({ map, clock, rate, baud, uart, from_s, to_s }, shown) {
  return {
    ...(shown.map && map !== "" ? { map } : {}),
    ...(clock ? { clock_hz: clock } : {}),
    ...(shown.rate && rate ? { sample_rate_hz: BigInt(rate) } : {}),
    ...(shown.baud && baud ? { baud } : {}),
    ...(shown.uart ? { uart } : {}),
    ...(from_s === null ? {} : { from_s }),
    ...(to_s === null ? {} : { to_s }),
  };
}
