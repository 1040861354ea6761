/**
 * The worker: holds the wasm core, judges a scenario once, runs it in slices, answers the views' questions about the
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
/** @type {any} The simulation that later ones are compared with; may be the finished one. */
let baseline = null;
/** Controller that the views look at. */
let selected = 0;
/** The scenario that was judged last, and the texts that it goes by: as it came, and as the core writes it. @type {{texts: string[], judged: any} | null} */
let held = null;
/** How often a scenario was read and planned, and how often one was run; a test reads it. */
const counts = { judged: 0, runs: 0 };
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
const yielding = [];
between.port1.onmessage = (event) => yielding.shift()?.(event);

/** Lets waiting messages in. */
function yieldToMessages() {
  return new Promise((resolve) => {
    yielding.push(resolve);
    between.port2.postMessage(0);
  });
}

/**
 * A scenario read, judged and planned: once for all that is asked of it until another one comes.
 * @param {string} json
 */
function judge(json) {
  if (held?.texts.includes(json)) return held.judged;
  counts.judged += 1;
  const judged = new core.Judged(json);
  held?.judged.free();
  held = { texts: [json], judged };
  return judged;
}

/** Asks of a scenario. @param {string} method @param {any[]} args  Its text first. */
function ofScenario(method, [json, ...args]) {
  const value = judge(String(json))[method](...args);
  // What could not be read stands at its default in the text that comes back: that is another scenario.
  if (method === "check" && value.problems.length === 0 && held?.texts.length === 1) held.texts.push(value.scenario);
  return value;
}

/** @param {{run: number, json: string, quiet?: boolean, select?: number}} order */
async function simulate({ run, json, quiet = false, select = 0 }) {
  const begin = performance.now();
  const simulation = judge(json).run();
  counts.runs += 1;
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
    await yieldToMessages();
    if (run !== newest) {
      simulation.free();
      return;
    }
  }
  if (finished !== baseline) finished?.free();
  finished = simulation;
  selected = 0;
  if (quiet) {
    selected = select;
    finished.select(select);
    return postMessage({ event: "restored" });
  }
  postMessage({ event: "done", run, summary: simulation.summary(), ms: performance.now() - begin });
}

/** Makes the finished run the one that later ones are compared with, or lets that one go. @param {boolean} on */
function setBaseline(on) {
  if (baseline !== finished) baseline?.free();
  baseline = on ? finished : null;
  return baseline !== null;
}

/** Asks of the baseline, about one of its controllers. @param {string} method @param {any[]} args  The controller first. */
function ofBaseline(method, [controller, ...args]) {
  if (!baseline) return null;
  // A run cannot be compared with itself: it is no other.
  const own = method === "motion" || method === "between";
  if (baseline === finished && !own) return null;
  baseline.select(controller);
  const value = own ? baseline[method](...args) : finished[method](baseline, ...args);
  if (baseline === finished) baseline.select(selected);
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
    await yieldToMessages();
    if (own !== searches || simulation !== finished) return null;
  }
}

/** @param {string} method @param {any[]} args */
function answer(method, args) {
  if (method === "baseline") return setBaseline(args[0]);
  if (method.startsWith("baseline_")) return ofBaseline(method.slice(9), args);
  if (method === "counts") return { ...counts };
  if (method in core.Judged.prototype) return ofScenario(method, args);
  if (method === "select") selected = args[0];
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
