/** The interface to the worker that reads recordings (capture_worker.js), one file at a time. */
import { byId } from "../dom.js";
import { PendingRequests } from "./pending_requests.js";
import { compiled } from "./wasm.js";

/**
 * @typedef {{format: string, channels: string[], count: number, map: string, has_levels: boolean, has_bytes: boolean, has_times: boolean,
 *   map_error: string | null, left_out: number, has_base: boolean, notes: string[], error: string | null}} Facts  `left_out`: channels beyond the first 64; `has_base`: bytes are written as numbers in some base.
 * @typedef {{channel: number, figures: {steps: number, right: number, left: number, turns: number, position: number,
 *   first_s: number, last_s: number, shortest_interval_s: number | null, shortest_at_s: number | null, greatest_rate_steps_s: number | null,
 *   mean_rate_steps_s: number | null, greatest_acceleration_steps_s2: number | null}}} ChannelSteps
 * @typedef {{from_s: number, to_s: number, end_s: number, records: number, of: number}} Part  The visible part of a longer recording.
 * @typedef {{map: string, clock_hz: number, rounding: string, end_s: number, records: number, part: Part | null, notes: string[],
 *   steps: ChannelSteps[], lines: string[]}} Preview
 * @typedef {{line: string, kind: string, start_cycle: number, end_cycle: number, bytes: number[], meaning: string, outcome: string}} LinePacket
 * @typedef {{position_min: number[], position_max: number[], speed_min: number[], speed_max: number[]}} Columns  In steps and steps/s.
 * @typedef {{total: number, replies: number, rows: LinePacket[], csv: string}} LinePackets
 * @typedef {{bytes: Uint8Array, unknown: number}} Replies  Empty if the device was silent; `unknown` packets have no known controller.
 * @typedef {{map?: string, clock_hz?: number, sample_rate_hz?: bigint, baud?: number, uart?: string, at_s?: number, channel?: number, aligned?: number, from_s?: number, to_s?: number}} OpenRequest
 * @typedef {{map?: string, base?: string}} ReadOptions  Channels that are read first if there are more than 64; base of bytes.
 * @typedef {{records: Uint8Array, clock_hz: number, channel: number, baud: number, aligned: number}} Model  Records of a channel and RX of a run, and the step or byte to align by.
 */

/** Maximum changes, bytes or positions that are read. A change takes two to four bytes of memory, a byte or position 16. */
const MAX_ROWS = 120_000_000;
/** Maximum changes in the views. Each takes 64 bytes during transfer, and 16 bytes in four copies. */
const MAX_SHOWN = 20_000_000;
/** Records per message. */
const PIECE = 1 << 19;

/**
 * @param {File | string} file  Or the name of a sample. @param {(part: number) => void} onProgress
 * @param {ReadOptions} [options]
 */
export function openCapture(file, onProgress, options = {}) {
  const worker = new Worker(/** @type {string} */ (byId("main").dataset.captureWorker), { type: "module" });
  const requests = new PendingRequests();
  /** File name and scenario of a sample. @type {{file: string, scenario: string} | null} */
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
      requests.settle(data);
    };
    compiled("recordings").then((module) => {
      worker.postMessage({ module });
      worker.postMessage(typeof file === "string" ? { sample: file } : { file, most: MAX_ROWS, ...options });
    }, reject);
  });

  /** @param {string} method @param {...any} args @returns {Promise<any>} */
  const call = (method, ...args) => requests.add((id) => worker.postMessage({ id, method, args }));

  return {
    facts,
    sample: () => sample,
    /** @param {OpenRequest} request @returns {Promise<Preview>} */
    preview: (request) => call("preview", { most: MAX_SHOWN, ...request }),
    /** Overview of a channel. @param {number} channel @param {number} columns @returns {Promise<Columns | null>} */
    overview: (channel, columns) => call("overview", channel, columns),
    /** Scenarios of the recording; the first one without problems is to be shown. @param {boolean} ofSteps @returns {Promise<string[]>} */
    scenarios: (ofSteps) => call("scenarios", sample?.file ?? /** @type {File} */ (file).name, ofSteps),
    /** Packets on its lines: the first `maxRows`, and all as CSV. @param {boolean} addressed @param {number} maxRows @returns {Promise<LinePackets | null>} */
    packets: (addressed, maxRows) => call("packets", addressed, maxRows),
    /** Replies on TX, by the addresses of controllers. @param {number[]} addresses @returns {Promise<Replies | undefined>} */
    replies: (addresses) => call("replies", addresses),
    /** Time of a step or byte of a run, in s. @param {Model} model @returns {Promise<number | undefined>} */
    timeOf: ({ records, clock_hz, channel, baud, aligned }) =>
      call("time_of", records, clock_hz, channel, baud, aligned),
    /** Comparison with a run. @param {Model} model @returns {Promise<any>} */
    comparison: ({ records, clock_hz, channel, baud, aligned }) =>
      call("comparison", records, clock_hz, channel, baud, aligned),
    /** All records, in pieces. @param {number} count @returns {Promise<Uint8Array[]>} */
    async records(count) {
      const pieces = [];
      for (let from = 0; from < count; from += PIECE) {
        const piece = await call("records", from, PIECE);
        if (piece.length > 0) pieces.push(piece);
      }
      return pieces;
    },
    close: () => worker.terminate(),
  };
}
