/**
 * Talks to the worker: requests, one run at a time, and a new worker after a crash or a cancel without a reply. A new worker
 * repeats the last valid run for the views. Long requests go to additional workers (worker_pool.js).
 */
import { byId } from "../dom.js";
import { Dropped, RequestSlots } from "./request_slots.js";
import { compiled } from "./wasm.js";

/** @typedef {import("../state/types.js").Progress} Progress */
/** @typedef {import("../state/types.js").Summary} Summary */

/**
 * @typedef {object} Listener
 * @property {(revision: number, progress: Progress) => void} progress
 * @property {(revision: number, summary: Summary, ms: number) => void} done
 * @property {(revision: number, message: string) => void} failed
 * @property {(message: string) => void} crashed  A new worker has started.
 * @property {() => void} restored  After a crash the last valid run is available again; requests have to be repeated.
 * @property {() => void} stopped  A cancel got no reply; a new worker has started, and open requests are dropped.
 */

/** @typedef {{id: number, scenario: string, pieces: Uint8Array[], replies?: Uint8Array}} Recording */

/** Maximum time without a reply to a cancel, in ms. */
const PATIENCE_MS = 1000;

/** Recordings that undo can restore. */
const MAX_RECORDINGS = 3;
/** Error if the code of additional workers cannot be fetched. */
const MISSING = "this part of the page could not be loaded; check the network and try again";

export class Engine {
  #worker = this.#start();
  #listener;
  #next = 0;
  /** The current run; the last valid run; the run that a new worker repeats. @type {{run: number, json: string} | null} */
  #running = null;
  /** @type {{run: number, json: string} | null} */
  #good = null;
  /** @type {{run: number, json: string} | null} */
  #restoring = null;
  /** Recordings shown instead of the runs of these scenarios, newest last. @type {Recording[]} */
  #recordings = [];
  /** The controller that the worker has selected. */
  #selected = 0;
  #cancelling = 0;
  /** Additional workers, loaded on demand. @type {Promise<import("./worker_pool.js").WorkerPool> | null} */
  #loading = null;
  /** Crashes since the last reply; limits restarts. */
  #crashes = 0;
  /** @type {Map<number, {resolve: (value: any) => void, reject: (error: Error) => void}>} */
  #requests = new Map();
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
    const id = this.#next++;
    if (method === "select") this.#selected = args[0];
    return new Promise((resolve, reject) => {
      this.#requests.set(id, { resolve, reject });
      this.#worker.postMessage({ id, method, args });
    });
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
  record(scenario, pieces, replies) {
    this.#recordings = [...this.#recordings, { id: this.#next++, scenario, pieces, replies }].slice(-MAX_RECORDINGS);
    void this.#give(this.#recordings.slice(-1));
  }

  /** Sends recordings to the worker in pieces, so that the page stays responsive. @param {Recording[]} recordings */
  async #give(recordings) {
    const worker = this.#worker;
    for (const { id, scenario, pieces, replies } of recordings)
      worker.postMessage({ recording: id, scenario, count: pieces.length, replies });
    for (const { id, pieces } of recordings) {
      for (const piece of pieces) {
        await new Promise((rested) => setTimeout(rested));
        if (worker !== this.#worker) return;
        worker.postMessage({ piece, of: id });
      }
    }
  }

  /** Cancels an unfinished run. @param {number} revision */
  cancel(revision) {
    this.#running = null;
    this.#worker.postMessage({ cancel: revision });
    clearTimeout(this.#cancelling);
    this.#cancelling = window.setTimeout(() => {
      this.#renew("canceled");
      this.#listener.stopped();
    }, PATIENCE_MS);
  }

  #start() {
    const worker = startWorker();
    worker.onmessage = ({ data }) => this.#receive(data);
    worker.onerror = (event) => this.#restart(event.message || "the engine could not be loaded");
    return worker;
  }

  async #pool() {
    try {
      this.#loading ??= import("./worker_pool.js").then(({ WorkerPool }) => new WorkerPool(Dropped, MISSING));
      return await this.#loading;
    } catch {
      this.#loading = null;
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
  async consider(slot, method, ...args) {
    return (await this.#pool()).consider(slot, method, args);
  }

  /**
   * The same for the last valid run, which the worker repeats.
   * @param {string} slot @param {string} method @param {...any} args
   * @returns {Promise<any>}  undefined if there is no run.
   */
  async considerRun(slot, method, ...args) {
    const good = this.#good ?? this.#restoring;
    return good === null ? undefined : this.consider(slot, method, good.json, ...args);
  }

  /**
   * Several requests to one additional worker about the last valid run: `open` creates an object of its scenario, `of` calls
   * it.
   * @template T
   * @param {(request: (method: "open" | "of", ...args: any[]) => Promise<any>, json: string) => Promise<T>} work
   * @returns {Promise<T | null>}  null if there is no run.
   */
  async session(work) {
    const good = this.#good ?? this.#restoring;
    if (good === null) return null;
    return (await this.#pool()).session((request) => work(request, good.json));
  }

  /** @param {any} data */
  #receive(data) {
    if (data.event !== "crashed") this.#crashes = 0;
    switch (data.event) {
      case "progress":
        return this.#listener.progress(data.run, data.progress);
      case "restored":
        this.#good ??= this.#restoring;
        return this.#listener.restored();
      case "canceled":
        return clearTimeout(this.#cancelling);
      case "done":
        if (this.#running?.run === data.run) [this.#good, this.#running] = [this.#running, null];
        return this.#listener.done(data.run, data.summary, data.ms);
      case "failed":
        return this.#listener.failed(data.run, data.message);
      case "crashed":
        return this.#restart(data.message);
    }
    const request = this.#requests.get(data.id);
    this.#requests.delete(data.id);
    if ("error" in data) request?.reject(new Error(data.error));
    else request?.resolve(data.value);
  }

  /** @param {string} message */
  #restart(message) {
    // The run that ended the worker is not repeated.
    this.#running = null;
    if (++this.#crashes <= 2) this.#renew(message);
    else this.#drop(message);
    this.#listener.crashed(message);
  }

  /** Starts a new worker after too many crashes. */
  revive() {
    if (this.#crashes <= 2) return;
    this.#crashes = 0;
    this.#renew("restarted");
  }

  /** Replaces the worker. @param {string} why */
  #renew(why) {
    this.#drop(why);
    this.#worker = this.#start();
    void this.#give(this.#recordings);
    // If it also ends this worker, it is not repeated.
    [this.#restoring, this.#good] = [this.#good, null];
    if (this.#restoring) this.#worker.postMessage({ ...this.#restoring, quiet: true, select: this.#selected });
    // Requested after the cancel.
    if (this.#running) this.#worker.postMessage(this.#running);
  }

  /** @param {string} why */
  #drop(why) {
    clearTimeout(this.#cancelling);
    this.#worker.terminate();
    const open = [...this.#requests.values()];
    this.#requests.clear();
    for (const { reject } of open) reject(new Dropped(why));
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
