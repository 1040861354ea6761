/** Texts of the dialog of a recording, and its scenario. */
import { readJson } from "../../state/json.js";
import { count, counted, plain, si, time } from "../../state/number.js";
import { locationAround } from "../sender_comparison.js";

/** @typedef {import("../../engine/capture.js").Facts} Facts */
/** @typedef {import("../../engine/capture.js").Preview} Preview */
/** @typedef {import("../../engine/capture.js").LinePacket} LinePacket */
/** @typedef {import("../../engine/capture.js").LinePackets} LinePackets */
/** @typedef {import("../../engine/capture.js").Replies} Replies */
/**
 * The core's comparison of a recording with the baseline, step by step or byte by byte.
 * @typedef {{kind: string, recorded: number, model: number, differing: number, largest: {step: number, late_s: number, recorded_s: number},
 *   rms_s: number, drift_ppm: number, largest_jitter_s: number, rms_jitter_s: number, outliers: number, other_values: number,
 *   missing: number, extra: number, differences: {count: number}, rows: {text: string, recorded_s: number}[]}} Comparison
 */

/** Maximum packets in the dialog; the file has all. */
export const MAX_PACKETS = 100;
/** Maximum bytes of a packet in the dialog. */
const MAX_BYTES = 32;
/** Maximum drift that is reported; a larger one means a different motion. */
const MAX_DRIFT_PPM = 50_000;
/** Maximum differences in a message. */
const MAX_DIFFERENCES = 3;
/** Maximum characters of a note. */
const MAX_NOTE = 2000;

/** A message of the core as a sentence. @param {string} text */
export function sentence(text) {
  return `${text.slice(0, 1).toUpperCase()}${text.slice(1).replace(/\.$/, "")}.`;
}

/** @param {Facts} facts */
export function formatText({ format, count, has_levels, has_bytes }) {
  return `${format}, ${counted(count, has_levels ? "change" : has_bytes ? "byte" : "row")}`;
}

/** The visible part of a longer recording. @param {NonNullable<Preview["part"]>} part */
export function partText({ from_s, to_s, end_s, records, of }) {
  return `Shown: ${time(from_s)} to ${time(to_s)} of ${time(end_s)}, ${count(records)} of ${counted(of, "change")}`;
}

/** @param {Preview} found */
export function lengthText({ clock_hz, rounding, end_s, part }) {
  return `${time(part?.end_s ?? end_s)} at ${si(clock_hz, "Hz", 6)}: ${rounding}.`;
}

/** @param {import("../../engine/capture.js").ChannelSteps} channel */
export function stepsText({ channel, figures }) {
  const { steps, right, left, first_s, last_s, shortest_at_s } = figures;
  const { greatest_rate_steps_s: rate, greatest_acceleration_steps_s2: acceleration } = figures;
  const peak = rate ? `; maximum rate ${plain(rate, "steps/s")} at ${time(shortest_at_s ?? 0)}` : "";
  const steepest = acceleration ? `, maximum acceleration ${plain(acceleration, "steps/s²")}` : "";
  return `Channel ${channel}: ${counted(steps, "step")}, ${count(right)} right and ${count(left)} left, from ${time(first_s)} to ${time(last_s)}${peak}${steepest}.`;
}

/** @param {string} file */
export const packetsFile = (file) => `${file.replace(/\.[^.]*$/, "")}-packets.csv`;

/** @param {LinePackets} packets */
export function packetsText({ total, replies, rows }) {
  const more = total > rows.length ? `; the first ${count(rows.length)}:` : ":";
  return `${counted(total, "packet")}, ${count(replies)} complete frames of the device${more} `;
}

/** @param {LinePacket} packet @param {number} clock_hz */
export function packetCells({ line, kind, start_cycle, bytes, meaning, outcome }, clock_hz) {
  const listed = bytes.slice(0, MAX_BYTES).map((byte) => byte.toString(16).padStart(2, "0"));
  const hex = listed.join(" ") + (bytes.length > listed.length ? " …" : "");
  const parts = [meaning, outcome].filter((text) => text !== "");
  return [`${line} ${kind}`, time(start_cycle / clock_hz), hex, parts.join("; ")];
}

/** The comparison of steps or bytes with the baseline as text. @param {Comparison} comparison @param {number} aligned */
export function comparisonText(comparison, aligned) {
  const { kind, differing, largest, rms_s, other_values } = comparison;
  const noun = kind.slice(0, -1);
  const by = aligned > 0 ? `, aligned by ${noun} ${count(aligned)}` : "";
  const { step, late_s } = largest;
  const late =
    late_s === 0
      ? "no deviation"
      : `${noun} ${count(step)} (the first is 0) has the maximum deviation, ${time(Math.abs(late_s))} ${late_s > 0 ? "late" : "early"}`;
  const values = other_values > 0 ? `, ${count(other_values)} with another value` : "";
  return `Compared with the baseline${by}: ${comparedCounts(comparison)} compared, ${count(differing)} differ by more than one clock cycle; ${late}${values}; RMS ${time(rms_s)}.${listedDifferences(comparison)}${driftText(comparison)}`;
}

/** @param {Comparison} comparison */
function comparedCounts({ kind, recorded, model, missing, extra }) {
  if (missing + extra === 0) return `all ${count(recorded)} ${kind}`;
  return `${count(recorded)} ${kind}, the baseline has ${count(model)}, ${count(missing)} missing, ${count(extra)} extra; the others`;
}

/** @param {Comparison} comparison */
function listedDifferences({ rows, differences }) {
  if (differences.count === 0) return "";
  const listed = rows.slice(0, MAX_DIFFERENCES).map(({ text }) => text);
  const more = differences.count > listed.length ? `; ${count(differences.count)} differences in total` : "";
  return ` ${listed.join("; ")}${more}.`;
}

/** @param {Comparison} comparison */
function driftText({ drift_ppm, largest_jitter_s, rms_jitter_s, outliers }) {
  if (Math.abs(drift_ppm) > MAX_DRIFT_PPM) return "";
  const excluded = outliers > 0 ? `, ${counted(outliers, "outlier")} excluded` : "";
  const drift = drift_ppm.toFixed(1).replace(/^-(0\.0)$/, "$1");
  return ` Drift ${drift} ppm; without drift: maximum deviation ${time(largest_jitter_s)}, RMS jitter ${time(rms_jitter_s)}${excluded}.`;
}

/** A location that shows the step with the maximum deviation, its planned time, and some neighbors. @param {Comparison} comparison @param {import("../../state/types.js").Result} result */
export function worstLocation({ largest, recorded }, { summary, controller }) {
  const { clock_hz, end_cycle } = summary;
  const cycle = Math.round(largest.recorded_s * clock_hz);
  const margin = Math.round(Math.max(4 * Math.abs(largest.late_s) * clock_hz, (4 * end_cycle) / recorded));
  return { ...locationAround(cycle - margin, cycle + margin, end_cycle, controller), cycle };
}

/**
 * The message of an imported recording.
 * @param {{file: string, part: Preview["part"], isRecorded: boolean, hasBaseline: boolean, replies: Replies | undefined, isShort: boolean, own: string}} imported
 *   `own`: the hint about the user's work.
 */
export function importedText({ file, part: visible, isRecorded, hasBaseline, replies, isShort, own }) {
  const part = isRecorded && visible ? ` ${partText(visible)}; its position begins at 0.` : "";
  const unknown = replies?.unknown
    ? ` ${counted(replies.unknown, "packet")} on TX have no known controller; they are in the table of the first one.`
    : "";
  if (isShort) return `Opened ${file}.${part}${unknown}${own}`;
  const shown = isRecorded ? "The views show the recording." : "The views show the simulation.";
  const table =
    replies === undefined
      ? ""
      : replies.bytes.length > 0
        ? " The packets show the recorded replies."
        : " TX has no bytes, so the packets show no replies.";
  const baseline = hasBaseline ? " The previous experiment is the baseline." : "";
  return `Opened ${file}. ${shown}${part}${table}${unknown}${baseline}${own}`;
}

/** The scenario of recorded bytes with the controllers of the previous experiment, if the clocks are equal. @param {string} json @param {any} base */
export function withControllers(json, base) {
  const { source, clock_hz, line, title, note, run_cycles } = readJson(json);
  if (!source.line || clock_hz !== base.clock_hz) return json;
  const own = { ...base.line, baud: line.baud, noise: {} };
  const controllers = base.controllers.map((/** @type {any} */ each) => ({ ...each, axes: [], packets: [] }));
  return JSON.stringify({ ...base, source, title, note, run_cycles, line: own, controllers });
}

/** A note with one more sentence, cut to the maximum length. @param {string} note @param {string} text */
export const extendedNote = (note, text) => [...`${note} ${text}`].slice(0, MAX_NOTE).join("");
