/**
 * The worker: holds the wasm core, judges a scenario once, runs it in slices, answers the views' questions about the
 * last finished run. Between two slices it reads its messages, so a newer scenario ends an older run.
 *
 * In: first of all {module}, the compiled core; {id, method, args} for an answer {id, value} or {id, error};
 * {recording}, the number of a scenario whose run is looked at as it was recorded, and how many {piece} of it come; {run, json} for events {event, run, …}, without a word of it if `quiet`, and then looking at controller `select`;
 * {cancel} for {event: "cancelled"} once that run is no longer under way.
 */
import init, {
  default_scenario,
  drivers,
  Judged,
  link_part,
  link_with,
  open_link,
  presets,
  schema,
} from "../pkg/stepscope_wasm.js";
import { awaitModule, createJudging, fatal, text } from "./judging.js";

/** How long a slice should take, in ms: short enough to be cancelled within a tenth of a second. */
const SLICE_MS = 15;
/** Least time between two reports of progress, in ms. */
const REPORT_MS = 60;
/** Records that are handed on at a time. */
const PIECE = 1 << 19;

/** @type {any} The simulation that the views ask about. */
let finished = null;
/** @type {any} The simulation that later ones are compared with; may be the finished one. */
let baseline = null;
/** Controller that the views look at. */
let selected = 0;
const judging = createJudging((json) => new Judged(json));
/** Questions about no run. @type {{[method: string]: (...args: any[]) => any}} */
const CALLS = { decode_link: open_link, default_scenario, drivers, link_part, link_with, presets, schema };
/** How often a scenario was run; a test reads it. */
let runs = 0;
/** No run has this number. */
const NONE = -2;
/** Number of the newest run that was asked for. */
let newest = NONE;

const { provide, ready } = awaitModule(init);
/** The newest last; their pieces may still come. @type {{recording: number, scenario: string, count: number, replies?: Uint8Array, pieces: Uint8Array[]}[]} */
let recordings = [];
/** As many as the page has. */
const MAX_RECORDINGS = 3;
/** Goes on with a run that waits for a message: a piece of its recording, or a newer run. @type {(heard?: unknown) => void} */
let goOn = () => {};
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

/** Asks of a scenario. @param {string} method @param {any[]} args  Its text first. */
function ofScenario(method, [text, ...args]) {
  const json = String(text);
  // What is judged next frees it: it is asked at once.
  const value = /** @type {any} */ (judging.judge(json))[method](...args);
  // What could not be read stands at its default in the text that comes back: that is another scenario.
  if (method === "check" && value.problems.length === 0) judging.alias(value.scenario);
  return value;
}

/** What a recording stands for: as long as this is the same, it is looked at. @param {string} json */
function recordable(json) {
  const { source, clock_hz, bus, run_cycles, plant } = JSON.parse(json);
  return JSON.stringify([source, clock_hz, bus.channels, run_cycles, plant]);
}

/**
 * Makes a run in slices.
 * @param {any} simulation @param {{run: number, quiet?: boolean}} order
 * @returns {Promise<boolean>}  Whether it came to its end: where a newer one came, it is freed.
 */
async function runInSlices(simulation, { run, quiet = false }) {
  let records = 4096;
  let reported = performance.now();
  for (;;) {
    const before = performance.now();
    const progress = simulation.advance(records);
    const now = performance.now();
    if (progress.done) return true;
    records = Math.min(4_000_000, Math.max(256, Math.round((records * SLICE_MS) / Math.max(0.5, now - before))));
    if (now - reported > REPORT_MS && !quiet) {
      reported = now;
      postMessage({ event: "progress", run, progress: { ...progress } });
    }
    await yieldToMessages();
    if (run !== newest) {
      letGo(simulation);
      return false;
    }
  }
}

/** @param {{run: number, json: string, quiet?: boolean, select?: number}} order */
async function simulate(order) {
  const { run, json, quiet = false, select = 0 } = order;
  const begin = performance.now();
  const scenario = /** @type {any} */ (judging.judge(json));
  runs += 1;
  const simulation = scenario.run();
  const recording = recordings.findLast(({ scenario }) => recordable(scenario) === recordable(json));
  if (recording?.replies) simulation.answer(recording.replies);
  for (let at = 0; recording && at < recording.count; ) {
    const piece = recording.pieces[at];
    if (piece) {
      simulation.record(piece, (recording.count - at) * PIECE);
      at += 1;
    }
    await (piece
      ? yieldToMessages()
      : new Promise((resolve) => {
          goOn = resolve;
        }));
    if (run !== newest) return letGo(simulation);
  }
  if (!(await runInSlices(simulation, order))) return;
  if (finished !== baseline) letGo(finished);
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
function letGo(simulation) {
  simulation?.free();
}

/** Makes the finished run the one that later ones are compared with, or lets that one go. @param {boolean} on */
function setBaseline(on) {
  if (baseline !== finished) letGo(baseline);
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
async function answer(method, args) {
  if (method === "baseline") return setBaseline(args[0]);
  if (method.startsWith("baseline_")) return ofBaseline(method.slice(9), args);
  if (method === "counts") return { judged: judging.count(), runs };
  if (method === "encode_link") return ofScenario("link", args);
  if (method in Judged.prototype) return ofScenario(method, args);
  if (method === "select") selected = args[0];
  if (method === "filter") return search(args);
  const call = CALLS[method];
  if (call) return call(...args);
  if (!finished) return null;
  return finished[method](...args);
}

self.onmessage = async ({ data }) => {
  goOn();
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
