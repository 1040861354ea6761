/** Sends recordings to the worker in pieces, so that the page stays responsive. */
import { sleep } from "./sleep.js";

/** @typedef {{id: number, scenario: string, pieces: Uint8Array[], replies?: Uint8Array}} Recording */

/** Recordings that undo can restore; the worker has the same limit. */
export const MAX_RECORDINGS = 3;

/** @param {Worker} worker @param {Recording[]} recordings @param {() => boolean} isCurrent  Whether the worker is still in use. */
export async function sendRecordings(worker, recordings, isCurrent) {
  for (const { id, scenario, pieces, replies } of recordings)
    worker.postMessage({ recording: id, scenario, count: pieces.length, replies });
  for (const { id, pieces } of recordings) {
    for (const piece of pieces) {
      await sleep();
      if (!isCurrent()) return;
      worker.postMessage({ piece, of: id });
    }
  }
}
