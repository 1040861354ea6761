/**
 * The worker: validates scenarios, runs them in slices, and serves requests about the last finished run. It reads messages
 * between slices, so a newer scenario ends an older run.
 *
 * In: first {module}, the compiled core; {id, method, args}, replied with {id, value} or {id, error}; {recording} and its
 * {piece}s, shown instead of a run; {run, json}, replied with events {event, run, …}, or only {event: "restored"} if `quiet`;
 * {cancel}, replied with {event: "canceled"}.
 */
import init, {
  default_scenario,
  drivers,
  link_part,
  link_with,
  open_link,
  presets,
  schema,
  ValidatedScenario,
} from "../pkg/stepscope_wasm.js";
import { errorMessage } from "../state/error_message.js";
import { MAX_RECORDINGS } from "./recordings.js";
import { FIRST_SLICE, nextSliceSize, yieldToMessages } from "./slices.js";
import { awaitModule, createScenarioCache, isFatal } from "./worker_common.js";

/** Minimum time between two reports of progress, in ms. */
const REPORT_MS = 60;
/** Records per message. */
const PIECE = 1 << 19;

/** @type {any} The simulation that the views show. */
let finished = null;
/** @type {any} The baseline; may be the finished simulation. */
let baseline = null;
/** Controller that the views show. */
let selected = 0;
const scenarios = createScenarioCache((json) => new ValidatedScenario(json));
/** Requests without a run. @type {{[method: string]: (...args: any[]) => any}} */
const CALLS = { decode_link: open_link, default_scenario, drivers, link_part, link_with, presets, schema };
/** Number of runs since the start, for a test. */
let runs = 0;
/** The number of no run. */
const NONE = -2;
/** Number of the newest requested run. */
let newest = NONE;

const { provide, ready } = awaitModule(init);
/** @typedef {{recording: number, scenario: string, count: number, replies?: Uint8Array, pieces: Uint8Array[]}} Recording  `count`: number of pieces; some may still arrive. */
/** Newest last. @type {Recording[]} */
let recordings = [];
/** Resumes a run that waits for a piece of its recording. @type {(message?: unknown) => void} */
let resume = () => {};

/** Calls a method of a scenario. @param {string} method @param {any[]} args  The JSON of the scenario first. */
function callScenario(method, [first, ...args]) {
  const json = String(first);
  // Used at once, because the next scenario frees it.
  const value = /** @type {any} */ (scenarios.get(json))[method](...args);
  // With problems, the returned JSON is another scenario.
  if (method === "check" && value.problems.length === 0) scenarios.alias(value.scenario);
  return value;
}

/** The part of a scenario that identifies its recording. @param {string} json */
function recordingKey(json) {
  const { source, clock_hz, bus, run_cycles, plant } = JSON.parse(json);
  return JSON.stringify([source, clock_hz, bus.channels, run_cycles, plant]);
}

/**
 * Runs in slices.
 * @param {any} simulation @param {{run: number, quiet?: boolean}} request
 * @returns {Promise<boolean>}  Whether it ended; if a newer run replaced it, it is freed.
 */
async function runInSlices(simulation, { run, quiet = false }) {
  let records = FIRST_SLICE;
  let reported = performance.now();
  for (;;) {
    const before = performance.now();
    const progress = simulation.advance(records);
    const now = performance.now();
    if (progress.done) return true;
    records = nextSliceSize(records, now - before);
    if (now - reported > REPORT_MS && !quiet) {
      reported = now;
      postMessage({ event: "progress", run, progress: { ...progress } });
    }
    await yieldToMessages();
    if (run !== newest) {
      release(simulation);
      return false;
    }
  }
}

/**
 * Adds a recording to a run, as its pieces arrive.
 * @param {any} simulation @param {Recording} recording @param {number} run
 * @returns {Promise<boolean>}  Whether it is complete; if a newer run replaced it, the simulation is freed.
 */
async function addRecording(simulation, { replies, count, pieces }, run) {
  if (replies) simulation.set_replies(replies);
  for (let added = 0; added < count; ) {
    const piece = pieces[added];
    if (piece) {
      simulation.record(piece, (count - added) * PIECE);
      added += 1;
      await yieldToMessages();
    } else {
      await new Promise((resolve) => {
        resume = resolve;
      });
    }
    if (run !== newest) {
      release(simulation);
      return false;
    }
  }
  return true;
}

/** @param {{run: number, json: string, quiet?: boolean, select?: number}} request */
async function simulate(request) {
  const { run, json, quiet = false, select = 0 } = request;
  const begin = performance.now();
  const scenario = /** @type {any} */ (scenarios.get(json));
  runs += 1;
  const simulation = scenario.run();
  const recording = recordings.findLast(({ scenario }) => recordingKey(scenario) === recordingKey(json));
  if (recording && !(await addRecording(simulation, recording, run))) return;
  if (!(await runInSlices(simulation, request))) return;
  if (finished !== baseline) release(finished);
  finished = simulation;
  selected = 0;
  if (quiet) {
    selected = select;
    finished.select(select);
    return postMessage({ event: "restored" });
  }
  postMessage({ event: "done", run, summary: simulation.summary(), ms: performance.now() - begin });
}

/** Frees a run. @param {any} simulation */
function release(simulation) {
  simulation?.free();
}

/** Sets or clears the baseline. @param {boolean} on */
function setBaseline(on) {
  if (baseline !== finished) release(baseline);
  baseline = on ? finished : null;
  return baseline !== null;
}

/** Calls a method of the baseline. @param {string} method @param {any[]} args  The controller first. */
function callBaseline(method, [controller, ...args]) {
  if (!baseline) return null;
  // The other methods compare the run with the baseline.
  const isAboutBaseline = method === "motion" || method === "between";
  if (baseline === finished && !isAboutBaseline) return null;
  baseline.select(controller);
  const value = isAboutBaseline ? baseline[method](...args) : finished[method](baseline, ...args);
  if (baseline === finished) baseline.select(selected);
  return value;
}

/** Number of the newest packet search. */
let searches = 0;

/** Searches packets in slices; null if a newer search or run replaced it. @param {any[]} args */
async function search(args) {
  const own = ++searches;
  const simulation = finished;
  if (!simulation) return null;
  const note = simulation.filter(...args);
  let rows = FIRST_SLICE;
  for (;;) {
    const before = performance.now();
    const found = simulation.advance_filter(rows);
    if (found.done) return { note, ...found };
    rows = nextSliceSize(rows, performance.now() - before);
    await yieldToMessages();
    if (own !== searches || simulation !== finished) return null;
  }
}

/** @param {string} method @param {any[]} args */
async function reply(method, args) {
  if (method === "baseline") return setBaseline(args[0]);
  if (method.startsWith("baseline_")) return callBaseline(method.slice("baseline_".length), args);
  if (method === "counts") return { validated: scenarios.count(), runs };
  if (method === "encode_link") return callScenario("link", args);
  if (method in ValidatedScenario.prototype) return callScenario(method, args);
  if (method === "select") selected = args[0];
  if (method === "filter") return search(args);
  const call = CALLS[method];
  if (call) return call(...args);
  if (!finished) return null;
  return finished[method](...args);
}

self.onmessage = async ({ data }) => {
  resume();
  if ("module" in data) return provide(data.module);
  if ("recording" in data) {
    recordings = [...recordings, { ...data, pieces: [] }].slice(-MAX_RECORDINGS);
    return;
  }
  if ("piece" in data) {
    recordings.find(({ recording }) => recording === data.of)?.pieces.push(data.piece);
    return;
  }
  if ("cancel" in data) {
    if (newest === data.cancel) newest = NONE;
    return postMessage({ event: "canceled" });
  }
  if ("run" in data) newest = data.run;
  try {
    await ready;
    if ("run" in data) {
      if (data.run === newest) await simulate(data);
    } else {
      postMessage({ id: data.id, value: await reply(data.method, data.args) });
    }
  } catch (error) {
    if (isFatal(error)) postMessage({ event: "crashed", message: errorMessage(error) });
    else if ("run" in data) postMessage({ event: "failed", run: data.run, message: errorMessage(error) });
    else postMessage({ id: data.id, error: errorMessage(error) });
  }
};
