/**
 * The worker: holds the wasm core, runs a scenario in slices, answers the views' questions about the
 * last finished run. Between two slices it reads its messages, so a newer scenario ends an older run.
 *
 * In: first of all {module}, the compiled core; {id, method, args} for an answer {id, value} or {id, error};
 * {run, json} for events {event, run, …}, without a word of it if `quiet`, and then looking at controller `select`;
 * {cancel} for {event: "cancelled"} once that run is no longer under way.
 */
import init, * as core from "../pkg/stepscope_wasm.js";

/** How long a slice should take, in ms: short enough to be cancelled within a tenth of a second. */
const SLICE_MS = 15;
/** Least time between two reports of progress, in ms. */
const REPORT_MS = 60;

/** @type {any} The simulation that the views ask about. */
let finished = null;
/** No run has this number. */
const NONE = -2;
/** Number of the newest run that was asked for. */
let newest = NONE;

/** @type {(module: WebAssembly.Module) => void} */
let provide = () => {};
const ready = new Promise((resolve) => { provide = (module) => resolve(init({ module_or_path: module })); });
const between = new MessageChannel();

/** Lets waiting messages in. */
function breathe() {
  return new Promise((resolve) => {
    between.port1.onmessage = resolve;
    between.port2.postMessage(0);
  });
}

/** @param {{run: number, json: string, quiet?: boolean, select?: number}} order */
async function simulate({ run, json, quiet = false, select = 0 }) {
  const begin = performance.now();
  const simulation = new core.Simulation(json);
  let records = 4096;
  let reported = begin;
  for (;;) {
    const before = performance.now();
    const progress = simulation.advance(records);
    const now = performance.now();
    if (progress.done) break;
    records = Math.min(4_000_000, Math.max(256, Math.round((records * SLICE_MS) / Math.max(0.5, now - before))));
    if (now - reported > REPORT_MS && !quiet) {
      reported = now;
      postMessage({ event: "progress", run, progress: { ...progress } });
    }
    await breathe();
    if (run !== newest) {
      simulation.free();
      return;
    }
  }
  finished?.free();
  finished = simulation;
  if (quiet) {
    finished.select(select);
    return postMessage({ event: "restored" });
  }
  postMessage({ event: "done", run, summary: simulation.summary(), ms: performance.now() - begin });
}

/** Edges around a cycle: the level's begin and end, and the edge after that. @param {number} bit @param {number} cycle */
function pulseAt(bit, cycle) {
  const begin = finished.next_edge(bit, cycle + 1, false, "any");
  const end = finished.next_edge(bit, cycle, true, "any");
  const next = end === undefined ? undefined : finished.next_edge(bit, end, true, "any");
  return { begin, end, next };
}

/** @param {string} method @param {any[]} args */
function answer(method, args) {
  if (method === "pulse_at") return finished && pulseAt(args[0], args[1]);
  const calls = /** @type {any} */ (core);
  if (typeof calls[method] === "function") return calls[method](...args);
  return finished ? finished[method](...args) : null;
}

/** A panic leaves the wasm memory in no known state: the page has to start another worker. @param {unknown} error */
function fatal(error) {
  return error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
}

/** @param {unknown} error */
function text(error) {
  return error instanceof Error ? error.message : String(error);
}

onmessage = async ({ data }) => {
  if ("module" in data) return provide(data.module);
  if ("cancel" in data) {
    if (newest === data.cancel) newest = NONE;
    return postMessage({ event: "cancelled" });
  }
  if ("run" in data) newest = data.run;
  try {
    await ready;
    if ("run" in data) {
      if (data.run === newest) await simulate(data);
    } else {
      postMessage({ id: data.id, value: answer(data.method, data.args) });
    }
  } catch (error) {
    if (fatal(error)) postMessage({ event: "crashed", message: text(error) });
    else if ("run" in data) postMessage({ event: "failed", run: data.run, message: text(error) });
    else postMessage({ id: data.id, error: text(error) });
  }
};
