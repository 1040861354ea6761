/** Work in slices: between them the worker reads its messages. */

/** Duration of a slice, in ms; short enough to cancel within 100 ms. */
const SLICE_MS = 15;
/** Size of the first slice. */
export const FIRST_SLICE = 4096;
const [MIN_SLICE, MAX_SLICE] = [256, 4_000_000];
/** Shorter slices cannot be measured, in ms. */
const MIN_MEASURED_MS = 0.5;

/** The size of the next slice, such as its number of records. @param {number} size  Of the last slice. @param {number} ms  Its duration. */
export function nextSliceSize(size, ms) {
  const fitting = Math.round((size * SLICE_MS) / Math.max(MIN_MEASURED_MS, ms));
  return Math.min(MAX_SLICE, Math.max(MIN_SLICE, fitting));
}

const channel = new MessageChannel();
/** Tasks that wait for the messages. @type {((event: MessageEvent) => void)[]} */
const waiting = [];
channel.port1.onmessage = (event) => waiting.shift()?.(event);

/** Resolves after the messages that have already arrived. */
export function yieldToMessages() {
  return new Promise((resolve) => {
    waiting.push(resolve);
    channel.port2.postMessage(0);
  });
}
