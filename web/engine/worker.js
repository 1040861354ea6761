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
/** @type {any} The simulation that was kept to compare with; may be the finished one. */
let kept = null;
/** Controller that the views look at. */
let looked = 0;
/** No run has this number. */
const NONE = -2;
/** Number of the newest run that was asked for. */
let newest = NONE;

/** @type {(module: WebAssembly.Module) => void} */
let provide = () => {};
const ready = new Promise((resolve) => {
  provide = (module) => resolve(init({ module_or_path: module }));
});
const between = new MessageChannel();

/** Who waits for messages to be let in: a run, a search. @type {((event: MessageEvent) => void)[]} */
const breathing = [];
between.port1.onmessage = (event) => breathing.shift()?.(event);

/** Lets waiting messages in. */
function breathe() {
  return new Promise((resolve) => {
    breathing.push(resolve);
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
  if (finished !== kept) finished?.free();
  finished = simulation;
  looked = 0;
  if (quiet) {
    looked = select;
    finished.select(select);
    return postMessage({ event: "restored" });
  }
  postMessage({ event: "done", run, summary: simulation.summary(), ms: performance.now() - begin });
}

/** Keeps the finished run beside later ones, or lets the kept one go. @param {boolean} on */
function keep(on) {
  if (kept !== finished) kept?.free();
  kept = on ? finished : null;
  return kept !== null;
}

/** Asks the kept run, about one of its controllers. @param {string} method @param {any[]} args  The controller first. */
function ofKept(method, [controller, ...args]) {
  if (!kept) return null;
  // A run cannot be compared with itself: it is no other.
  if (kept === finished && method !== "motion") return null;
  kept.select(controller);
  const value = method === "motion" ? kept.motion(...args) : finished[method](kept, ...args);
  if (kept === finished) kept.select(looked);
  return value;
}

/** Number of the newest search over the packets. */
let searches = 0;

/** Looks for packets in slices: how many there are, or null where a newer search or run ended it. @param {any[]} args */
async function search(args) {
  const own = ++searches;
  const simulation = finished;
  if (!simulation) return null;
  const note = simulation.filter(...args);
  let rows = 4096;
  for (;;) {
    const before = performance.now();
    const found = simulation.filter_on(rows);
    if (found.done) return { note, ...found };
    rows = Math.min(
      4_000_000,
      Math.max(256, Math.round((rows * SLICE_MS) / Math.max(0.5, performance.now() - before))),
    );
    await breathe();
    if (own !== searches || simulation !== finished) return null;
  }
}

/** @param {string} method @param {any[]} args */
function answer(method, args) {
  if (method === "keep") return keep(args[0]);
  if (method.startsWith("kept_")) return ofKept(method.slice(5), args);
  if (method === "select") looked = args[0];
  if (method === "filter") return search(args);
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

self.onmessage = async ({ data }) => {
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
      postMessage({ id: data.id, value: await answer(data.method, data.args) });
    }
  } catch (error) {
    if (fatal(error)) postMessage({ event: "crashed", message: text(error) });
    else if ("run" in data) postMessage({ event: "failed", run: data.run, message: text(error) });
    else postMessage({ id: data.id, error: text(error) });
  }
};
