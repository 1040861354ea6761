/**
 * The worker that reads recordings in pieces.
 *
 * In: first {module}, the compiled code; {file, most, map, base} or {sample}, replied with {progress}, then {facts} or {error};
 * {id, method, args}, replied with {id, value} or {id, error}.
 */
import init, * as core from "../pkg-recordings/stepscope_wasm.js";
import { errorMessage } from "../state/error_message.js";
import { awaitModule, isFatal } from "./worker_common.js";

/** Minimum time between two reports of progress, in ms. */
const REPORT_MS = 60;

const { provide, ready } = awaitModule(init);
/** @type {any} */
let capture = null;

/** @param {{file: File, most: number, map?: string, base?: string}} request */
function open({ file, most, map, base }) {
  const reader = new FileReaderSync();
  let reported = performance.now();
  const piece = (/** @type {number} */ at, /** @type {number} */ length) =>
    new Uint8Array(reader.readAsArrayBuffer(file.slice(at, at + length)));
  const watch = (/** @type {number} */ bytes) => {
    const now = performance.now();
    if (now - reported < REPORT_MS) return;
    reported = now;
    postMessage({ progress: bytes / Math.max(1, file.size) });
  };
  capture = new core.CaptureFile(piece, file.size, watch, most, map, base);
  return capture.facts();
}

self.onmessage = async ({ data }) => {
  if ("module" in data) return provide(data.module);
  try {
    await ready;
    if ("file" in data) postMessage({ facts: open(data) });
    else if ("sample" in data) {
      capture = core.CaptureFile.sample(data.sample);
      postMessage({ facts: capture.facts(), sample: core.sample_facts(data.sample) });
    } else {
      const value = capture[data.method](...data.args);
      // Large arrays are transferred, not copied.
      postMessage({ id: data.id, value }, value instanceof Uint8Array ? [value.buffer] : []);
    }
  } catch (error) {
    const message = isFatal(error) ? "the file needs more memory than the browser provides" : errorMessage(error);
    // The field of the dialog that has to change, if known.
    const field = /** @type {{field?: string} | null} */ (error)?.field;
    postMessage(data.id === undefined ? { error: message } : { id: data.id, error: message, field });
  }
};
