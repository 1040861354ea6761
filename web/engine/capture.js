/** Talks to the worker that reads files of logic analysers (capture_worker.js), one file at a time. */
import { byId } from "../dom.js";
import { compiled } from "./wasm.js";

/**
 * @typedef {{format: string, channels: string[], count: number, map: string, has_levels: boolean, has_bytes: boolean, has_times: boolean,
 *   map_error: string | null, left_out: number, notes: string[], error: string | null}} Facts  `left_out`: channels beyond the first 64.
 * @typedef {{channel: number, figures: {steps: number, right: number, left: number, turns: number, position: number,
 *   first_s: number, last_s: number, shortest_interval_s: number | null, shortest_at_s: number | null, greatest_rate_steps_s: number | null,
 *   mean_rate_steps_s: number | null, greatest_acceleration_steps_s2: number | null}}} ChannelSteps
 * @typedef {{from_s: number, to_s: number, end_s: number, records: number, of: number}} Kept  The part that the views show, where that is not all.
 * @typedef {{map: string, clock_hz: number, rounding: string, end_s: number, records: number, kept: Kept | null, notes: string[],
 *   steps: ChannelSteps[], lines: string[]}} Looked
 * @typedef {{line: string, kind: string, start_cycle: number, end_cycle: number, bytes: number[], meaning: string, outcome: string}} LinePacket
 * @typedef {{position_min: number[], position_max: number[], speed_min: number[], speed_max: number[]}} Columns  In steps and steps/s.
 * @typedef {{total: number, replies: number, rows: LinePacket[], csv: string}} LinePackets
 * @typedef {{bytes: Uint8Array, unknown: number}} Replies  None in it where the device was silent; of `unknown` packets nothing says which controller's they are.
 * @typedef {{map?: string, clock_hz?: number, sample_rate_hz?: bigint, baud?: number, uart?: string, at_s?: number, channel?: number, aligned?: number, from_s?: number, to_s?: number}} Asked
 * @typedef {{records: Uint8Array, clock_hz: number, channel: number, baud: number, aligned: number}} Model  What a run has of a channel and of RX, and the step, or byte, that both have at one time.
 */

/** Most changes, bytes or positions that are read; in the worker a change takes two to four bytes, the others 16. */
const MOST_READ = 120_000_000;
/** Most changes that the views take: 64 bytes each on the way, 16 in this worker, in the page, in the engine's worker and in the run. */
const MOST_SHOWN = 20_000_000;
/** Records that are handed on at a time. */
const PIECE = 1 << 19;

/**
 * @param {File | string} file  Or the name of a sample. @param {(part: number) => void} onProgress
 * @param {string} [map]  Its channels are read first where the file has more than 64.
 */
export function openCapture(file, onProgress, map) {
  const worker = new Worker(/** @type {string} */ (byId("main").dataset.captureWorker), { type: "module" });
  /** @type {Map<number, {resolve: (value: any) => void, reject: (error: Error) => void}>} */
  const asked = new Map();
  let next = 0;
  /** What a sample is: its file's name, and the scenario that it was to follow. @type {{file: string, scenario: string} | null} */
  let sample = null;
  /** @type {Promise<Facts>} */
  const facts = new Promise((resolve, reject) => {
    worker.onerror = (event) => reject(new Error(event.message || "this part of the page could not be loaded"));
    worker.onmessage = ({ data }) => {
      if ("progress" in data) return onProgress(data.progress);
      if ("facts" in data) {
        sample = data.sample ?? null;
        return resolve(data.facts);
      }
      if (data.id === undefined) return reject(new Error(data.error));
      const question = asked.get(data.id);
      asked.delete(data.id);
      if ("error" in data) question?.reject(Object.assign(new Error(data.error), { field: data.field }));
      else question?.resolve(data.value);
    };
    compiled("tools").then((module) => {
      worker.postMessage({ module });
      worker.postMessage(typeof file === "string" ? { sample: file } : { file, most: MOST_READ, map });
    }, reject);
  });

  /** @param {string} method @param {...any} args @returns {Promise<any>} */
  const ask = (method, ...args) =>
    new Promise((resolve, reject) => {
      asked.set(next, { resolve, reject });
      worker.postMessage({ id: next++, method, args });
    });

  return {
    facts,
    sample: () => sample,
    /** @param {Asked} by @returns {Promise<Looked>} */
    look: (by) => ask("look", { most: MOST_SHOWN, ...by }),
    /** All of a channel at a glance. @param {number} channel @param {number} columns @returns {Promise<Columns | null>} */
    overview: (channel, columns) => ask("overview", channel, columns),
    /** The scenario that it is shown with. @param {boolean} ofSteps @returns {Promise<string>} */
    scenario: (ofSteps) => ask("scenario", sample?.file ?? /** @type {File} */ (file).name, ofSteps),
    /** What its lines say: the first `most` packets, and all of them as a table. @param {boolean} addressed @param {number} most @returns {Promise<LinePackets | null>} */
    packets: (addressed, most) => ask("packets", addressed, most),
    /** What TX says, dealt to controllers of these addresses, for the table of packets. @param {number[]} addresses @returns {Promise<Replies | undefined>} */
    replies: (addresses) => ask("replies", addresses),
    /** When the step, or byte, of a run comes, in s. @param {Model} of @returns {Promise<number | undefined>} */
    timeOf: ({ records, clock_hz, channel, baud, aligned }) =>
      ask("time_of", records, clock_hz, channel, baud, aligned),
    /** How it stands to a run. @param {Model} of @returns {Promise<any>} */
    beside: ({ records, clock_hz, channel, baud, aligned }) => ask("beside", records, clock_hz, channel, baud, aligned),
    /** All of its records, in pieces. @param {number} count @returns {Promise<Uint8Array[]>} */
    async records(count) {
      const pieces = [];
      for (let from = 0; from < count; from += PIECE) {
        const piece = await ask("records", from, PIECE);
        if (piece.length > 0) pieces.push(piece);
      }
      return pieces;
    },
    close: () => worker.terminate(),
  };
}
