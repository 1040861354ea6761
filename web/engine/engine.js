/**
 * The interface to the worker: requests, and one run at a time. A crash, or a cancel without a reply, starts a new worker, which
 * repeats the last valid run for the views. Long requests go to additional workers (worker_pool.js).
 */
import { byId } from "../dom.js";
import { PendingRequests } from "./pending_requests.js";
import { MAX_RECORDINGS, sendRecordings } from "./recordings.js";
import { Dropped, RequestSlots } from "./request_slots.js";
import { compiled } from "./wasm.js";

/** @typedef {import("../state/types.js").Progress} Progress */
/** @typedef {import("../state/types.js").Summary} Summary */
/** @typedef {{run: number, json: string}} Run  A revision and its scenario. */

/**
 * @typedef {object} Listener
 * @property {(revision: number, progress: Progress) => void} progress
 * @property {(revision: number, summary: Summary, ms: number) => void} done
 * @property {(revision: number, message: string) => void} failed
 * @property {(message: string) => void} crashed  A new worker has started.
 * @property {() => void} restored  After a crash the last valid run is available again; requests have to be repeated.
 * @property {() => void} stopped  A cancel got no reply; a new worker has started, and open requests are dropped.
 */

/** Maximum time without a reply to a cancel, in ms. */
const CANCEL_TIMEOUT_MS = 1000;
/** Crashes without a reply between them after which no new worker starts by itself. */
const MAX_CRASHES = 2;
/** Error if the code of additional workers cannot be fetched. */
const MISSING = "this part of the page could not be loaded; check the network and try again";

export class Engine {
  #worker = this.#start();
  #listener;
  /** Number of the next recording. */
  #nextRecording = 0;
  /** The current run. @type {Run | null} */
  #running = null;
  /** The last valid run. @type {Run | null} */
  #lastValid = null;
  /** The run that a new worker repeats. @type {Run | null} */
  #restoring = null;
  /** Recordings shown instead of the runs of these scenarios, newest last. @type {import("./recordings.js").Recording[]} */
  #recordings = [];
  /** The controller that the worker has selected. */
  #selected = 0;
  #cancelTimer = 0;
  /** Additional workers, loaded on demand. @type {Promise<import("./worker_pool.js").WorkerPool> | null} */
  #loadingPool = null;
  /** Crashes since the last reply; limits restarts. */
  #crashes = 0;
  #requests = new PendingRequests();
  #slots = new RequestSlots((method, args) => this.request(method, ...args));

  /** @param {Listener} listener */
  constructor(listener) {
    this.#listener = listener;
  }

  /**
   * Sends a request to the core (`check`, `encode_link`, …) or about the last finished run (`motion`, `pulses`, …).
   * @param {string} method
   * @param {...any} args
   * @returns {Promise<any>}  null if there is no run.
   */
  request(method, ...args) {
    if (method === "select") this.#selected = args[0];
    return this.#requests.add((id) => this.#worker.postMessage({ id, method, args }));
  }

  /**
   * Like `request`, but only the newest waiting request of a slot is sent (request_slots.js).
   * @param {string} slot @param {string} method @param {...any} args
   * @returns {Promise<any>}
   */
  latest(slot, method, ...args) {
    return this.#slots.latest(slot, method, args);
  }

  /** Runs a scenario and drops an unfinished run. @param {number} revision @param {string} json */
  run(revision, json) {
    this.#running = { run: revision, json };
    this.#worker.postMessage(this.#running);
  }

  /**
   * Shows a recording instead of the run of a scenario with this source, clock, channels and plant.
   * @param {string} scenario @param {Uint8Array[]} pieces  Its records, if any.
   * @param {Uint8Array} [replies]  Recorded replies.
   */
  showRecording(scenario, pieces, replies) {
    const recording = { id: this.#nextRecording++, scenario, pieces, replies };
    this.#recordings = [...this.#recordings, recording].slice(-MAX_RECORDINGS);
    void this.#send([recording]);
  }

  /** @param {import("./recordings.js").Recording[]} recordings */
  #send(recordings) {
    const worker = this.#worker;
    return sendRecordings(worker, recordings, () => worker === this.#worker);
  }

  /** Cancels an unfinished run. @param {number} revision */
  cancel(revision) {
    this.#running = null;
    this.#worker.postMessage({ cancel: revision });
    clearTimeout(this.#cancelTimer);
    this.#cancelTimer = window.setTimeout(() => {
      this.#renew("canceled");
      this.#listener.stopped();
    }, CANCEL_TIMEOUT_MS);
  }

  #start() {
    const worker = startWorker();
    worker.onmessage = ({ data }) => this.#receive(data);
    worker.onerror = (event) => this.#handleCrash(event.message || "the engine could not be loaded");
    return worker;
  }

  async #pool() {
    try {
      this.#loadingPool ??= import("./worker_pool.js").then(({ WorkerPool }) => new WorkerPool(Dropped, MISSING));
      return await this.#loadingPool;
    } catch {
      this.#loadingPool = null;
      throw new Error(MISSING);
    }
  }

  /**
   * Distributes a long request to additional workers; each piece is one call of the core. Runs and views do not wait for it.
   * @param {string} method @param {any[][]} pieces  The arguments of each call.
   * @param {AbortSignal} signal  Rejects it with `Dropped`.
   * @param {(at: number, reply: any) => void} [onReply]  Called with each reply.
   * @returns {Promise<any[]>}  All replies, in the order of the pieces.
   */
  async distribute(method, pieces, signal, onReply) {
    return (await this.#pool()).distribute(method, pieces, signal, onReply);
  }

  /**
   * A request to an additional worker; a newer one of its slot rejects it with `Dropped`.
   * @param {string} slot @param {string} method @param {...any} args
   * @returns {Promise<any>}
   */
  async compute(slot, method, ...args) {
    return (await this.#pool()).compute(slot, method, args);
  }

  /**
   * The same for the last valid run, which the worker repeats.
   * @param {string} slot @param {string} method @param {...any} args
   * @returns {Promise<any>}  undefined if there is no run.
   */
  async computeForRun(slot, method, ...args) {
    const run = this.#validRun();
    return run === null ? undefined : this.compute(slot, method, run.json, ...args);
  }

  /**
   * Several requests to one additional worker about the last valid run: `open` creates an object of its scenario, `of` calls
   * it.
   * @template T
   * @param {(request: (method: "open" | "of", ...args: any[]) => Promise<any>, json: string) => Promise<T>} work
   * @returns {Promise<T | null>}  null if there is no run.
   */
  async session(work) {
    const run = this.#validRun();
    if (run === null) return null;
    return (await this.#pool()).session((request) => work(request, run.json));
  }

  /** The last valid run, also while a new worker repeats it. */
  #validRun() {
    return this.#lastValid ?? this.#restoring;
  }

  /** @param {any} data */
  #receive(data) {
    if (data.event !== "crashed") this.#crashes = 0;
    switch (data.event) {
      case "progress":
        return this.#listener.progress(data.run, data.progress);
      case "restored":
        this.#lastValid ??= this.#restoring;
        return this.#listener.restored();
      case "canceled":
        return clearTimeout(this.#cancelTimer);
      case "done":
        if (this.#running?.run === data.run) [this.#lastValid, this.#running] = [this.#running, null];
        return this.#listener.done(data.run, data.summary, data.ms);
      case "failed":
        return this.#listener.failed(data.run, data.message);
      case "crashed":
        return this.#handleCrash(data.message);
    }
    this.#requests.settle(data);
  }

  /** @param {string} message */
  #handleCrash(message) {
    // The run that crashed the worker is not repeated.
    this.#running = null;
    if (++this.#crashes <= MAX_CRASHES) this.#renew(message);
    else this.#drop(message);
    this.#listener.crashed(message);
  }

  /** Starts a new worker after too many crashes. */
  revive() {
    if (this.#crashes <= MAX_CRASHES) return;
    this.#crashes = 0;
    this.#renew("restarted");
  }

  /** Replaces the worker. @param {string} reason */
  #renew(reason) {
    this.#drop(reason);
    this.#worker = this.#start();
    void this.#send(this.#recordings);
    // If it crashes this worker too, it is not repeated again.
    [this.#restoring, this.#lastValid] = [this.#lastValid, null];
    if (this.#restoring) this.#worker.postMessage({ ...this.#restoring, quiet: true, select: this.#selected });
    // A run that was requested after the cancel.
    if (this.#running) this.#worker.postMessage(this.#running);
  }

  /** @param {string} reason */
  #drop(reason) {
    clearTimeout(this.#cancelTimer);
    this.#worker.terminate();
    this.#requests.rejectAll(new Dropped(reason));
  }
}

/** A worker with the core. */
function startWorker() {
  const worker = new Worker(/** @type {string} */ (byId("main").dataset.worker), { type: "module" });
  compiled().then(
    (module) => worker.postMessage({ module }),
    // Loading the charts reports the error.
    () => {},
  );
  return worker;
}

/** Ignores `Dropped` and throws other errors. @param {unknown} error */
export function unlessDropped(error) {
  if (!(error instanceof Dropped)) throw error;
}
