/**
 * The worker that reads files of logic analysers: it reads them piece by piece, keeps what they hold and maps it.
 *
 * In: first of all {module}, the compiled code; {file, most, map}, the file, how much of it is kept and the map whose channels are read first, for {progress} now and
 * then, and {facts} or {error}; {sample}, the name of a sample, in the file's place; {id, method, args} for an answer {id, value} or {id, error}. Ending the worker cancels.
 */
import init, * as core from "../pkg-tools/stepscope_wasm.js";
import { awaitModule, fatal, text } from "./judging.js";

/** Least time between two reports of progress, in ms. */
const REPORT_MS = 60;

const { provide, ready } = awaitModule(init);
/** @type {any} */
let opened = null;

/** @param {File} file @param {number} most @param {string} [map] */
function open(file, most, map) {
  const reader = new FileReaderSync();
  let told = performance.now();
  const piece = (/** @type {number} */ at, /** @type {number} */ length) =>
    new Uint8Array(reader.readAsArrayBuffer(file.slice(at, at + length)));
  const watch = (/** @type {number} */ bytes) => {
    const now = performance.now();
    if (now - told < REPORT_MS) return;
    told = now;
    postMessage({ progress: bytes / Math.max(1, file.size) });
  };
  opened = new core.CaptureFile(piece, file.size, watch, most, map);
  return opened.facts();
}

self.onmessage = async ({ data }) => {
  if ("module" in data) return provide(data.module);
  try {
    await ready;
    if ("file" in data) postMessage({ facts: open(data.file, data.most, data.map) });
    else if ("sample" in data) {
      opened = core.CaptureFile.sample(data.sample);
      postMessage({ facts: opened.facts(), sample: core.sample_facts(data.sample) });
    } else {
      const value = opened[data.method](...data.args);
      // What is large goes over, and is not copied.
      postMessage({ id: data.id, value }, value instanceof Uint8Array ? [value.buffer] : []);
    }
  } catch (error) {
    const message = fatal(error) ? "the file needs more memory than this browser gives" : text(error);
    // Which field of the dialog has to be changed, where the core says so.
    const field = /** @type {{field?: string} | null} */ (error)?.field;
    postMessage(data.id === undefined ? { error: message } : { id: data.id, error: message, field });
  }
};
