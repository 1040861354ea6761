/**
 * The only module that talks to the worker: questions with answers, one run at a time, and a new
 * worker after a crash, or where a cancel is not heard in time. A new worker makes the last good run
 * once more, so that the views that show it can still ask. Long questions, those of the study, go to further workers
 * (further.js) and keep neither runs nor views waiting; they and their code load with the first of them.
 */
import { byId } from "../dom.js";
import { compiled } from "./wasm.js";

/** @typedef {import("../state/types.js").Progress} Progress */
/** @typedef {import("../state/types.js").Summary} Summary */

/**
 * @typedef {object} Listener
 * @property {(revision: number, progress: Progress) => void} progress
 * @property {(revision: number, summary: Summary, ms: number) => void} done
 * @property {(revision: number, message: string) => void} failed
 * @property {(message: string) => void} crashed  A new worker is there already.
 * @property {() => void} restored  After a crash the last good run is there again; what was asked meanwhile is to be asked anew.
 * @property {() => void} stopped  The worker did not hear a cancel; a new one is there, and open questions are dropped.
 */

/** @typedef {{id: number, scenario: string, pieces: Uint8Array[], replies?: Uint8Array}} Held  A recording. */

/** How long a cancel may go unanswered, in ms: one long call hears nothing. */
const PATIENCE_MS = 1000;

/** Recordings that undo finds again. */
const MAX_RECORDINGS = 3;
/** What is told where the study's code could not be fetched. */
const MISSING = "this part of the page could not be loaded; try again when the network is there";

/** Thrown into questions that no longer matter: a newer one took their place, or the worker is gone. */
export class Dropped extends Error {}

export class Engine {
  #worker = this.#start();
  #listener;
  #next = 0;
  /** The run under way, the last good one, and that one while another worker makes it again. @type {{run: number, json: string} | null} */
  #running = null;
  /** @type {{run: number, json: string} | null} */
  #good = null;
  /** @type {{run: number, json: string} | null} */
  #restoring = null;
  /** What is looked at in place of what these scenarios' runs make, the newest last. @type {Held[]} */
  #recordings = [];
  /** The controller that the worker was told to look at. */
  #selected = 0;
  #cancelling = 0;
  /** What has the further workers, once it is needed. @type {Promise<import("./further.js").Further> | null} */
  #loading = null;
  /** Crashes since the worker last answered; one that cannot even start is not started for ever. */
  #crashes = 0;
  /** @type {Map<number, {resolve: (value: any) => void, reject: (error: Error) => void}>} */
  #requests = new Map();
  /** @type {Map<string, {busy: boolean, waiting: null | {method: string, args: any[], resolve: (value: any) => void, reject: (error: Error) => void}}>} */
  #slots = new Map();

  /** @param {Listener} listener */
  constructor(listener) {
    this.#listener = listener;
  }

  /**
   * Asks the core (`check`, `encode_link`, …) or the last finished run (`motion`, `pulses`, …).
   * @param {string} method
   * @param {...any} args
   * @returns {Promise<any>}  null where there is no run to ask.
   */
  ask(method, ...args) {
    const id = this.#next++;
    if (method === "select") this.#selected = args[0];
    return new Promise((resolve, reject) => {
      this.#requests.set(id, { resolve, reject });
      this.#worker.postMessage({ id, method, args });
    });
  }

  /**
   * As `ask`, but of the questions that wait in one slot only the newest is put; the others end in
   * `Dropped`. So a moving pointer never builds a queue.
   * @param {string} slot
   * @param {string} method
   * @param {...any} args
   * @returns {Promise<any>}
   */
  latest(slot, method, ...args) {
    const state = this.#slots.get(slot) ?? { busy: false, waiting: null };
    this.#slots.set(slot, state);
    return new Promise((resolve, reject) => {
      state.waiting?.reject(new Dropped(slot));
      state.waiting = { method, args, resolve, reject };
      if (!state.busy) this.#pump(slot);
    });
  }

  /** @param {string} slot */
  async #pump(slot) {
    const state = this.#slots.get(slot);
    if (!state?.waiting) return;
    const { method, args, resolve, reject } = state.waiting;
    state.waiting = null;
    state.busy = true;
    try {
      resolve(await this.ask(method, ...args));
    } catch (error) {
      reject(/** @type {Error} */ (error));
    }
    state.busy = false;
    this.#pump(slot);
  }

  /** Runs a scenario; a run that is not done yet is dropped. @param {number} revision @param {string} json */
  run(revision, json) {
    this.#running = { run: revision, json };
    this.#worker.postMessage(this.#running);
  }

  /**
   * From now on a run of this scenario shows what was recorded, as long as its source, clock, channels and plant are the same.
   * @param {string} scenario @param {Uint8Array[]} pieces  Its records; none where what the run makes is looked at.
   * @param {Uint8Array} [replies]  What was recorded on TX, in the place of the run's replies.
   */
  record(scenario, pieces, replies) {
    this.#recordings = [...this.#recordings, { id: this.#next++, scenario, pieces, replies }].slice(-MAX_RECORDINGS);
    void this.#give(this.#recordings.slice(-1));
  }

  /** Gives recordings to the worker, a piece at a time: a copy of all would hold the page. @param {Held[]} recordings */
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

  /** Ends a run that is not done yet. @param {number} revision */
  cancel(revision) {
    this.#running = null;
    this.#worker.postMessage({ cancel: revision });
    clearTimeout(this.#cancelling);
    this.#cancelling = window.setTimeout(() => {
      this.#renew("cancelled");
      this.#listener.stopped();
    }, PATIENCE_MS);
  }

  #start() {
    const worker = another();
    worker.onmessage = ({ data }) => this.#heard(data);
    worker.onerror = (event) => this.#restart(event.message || "the engine could not be loaded");
    return worker;
  }

  /** What has the further workers. */
  async #further() {
    try {
      this.#loading ??= import("./further.js").then(({ Further }) => new Further(Dropped, MISSING));
      return await this.#loading;
    } catch {
      this.#loading = null;
      throw new Error(MISSING);
    }
  }

  /**
   * Distributes a long question: each piece is one call of the core, and further workers make them beside each other.
   * Neither the run nor the views' questions wait for it.
   * @param {string} method @param {any[][]} pieces  The arguments of each call.
   * @param {AbortSignal} signal  Ends it at once, in `Dropped`.
   * @param {(at: number, answer: any) => void} [onAnswer]  Hears each answer as it comes.
   * @returns {Promise<any[]>}  All answers, in the order of the pieces.
   */
  async distribute(method, pieces, signal, onAnswer) {
    return (await this.#further()).distribute(method, pieces, signal, onAnswer);
  }

  /**
   * One question to a further worker; a newer one in its slot ends it, in `Dropped`.
   * @param {string} slot @param {string} method @param {...any} args
   * @returns {Promise<any>}
   */
  async consider(slot, method, ...args) {
    return (await this.#further()).consider(slot, method, args);
  }

  /**
   * The same about the last good run, which the further worker makes again.
   * @param {string} slot @param {string} method @param {...any} args
   * @returns {Promise<any>}  undefined where there is no run to ask about.
   */
  async considerRun(slot, method, ...args) {
    const good = this.#good ?? this.#restoring;
    return good === null ? undefined : this.consider(slot, method, good.json, ...args);
  }

  /**
   * Several questions to one further worker, which keeps what it opened: `open` makes an object of a scenario, `of` asks
   * it. The last good run's scenario is at hand.
   * @template T
   * @param {(ask: (method: "open" | "of", ...args: any[]) => Promise<any>, json: string) => Promise<T>} work
   * @returns {Promise<T | null>}  null where there is no run.
   */
  async session(work) {
    const good = this.#good ?? this.#restoring;
    if (good === null) return null;
    return (await this.#further()).session((ask) => work(ask, good.json));
  }

  /** @param {any} data */
  #heard(data) {
    if (data.event !== "crashed") this.#crashes = 0;
    switch (data.event) {
      case "progress":
        return this.#listener.progress(data.run, data.progress);
      case "restored":
        this.#good ??= this.#restoring;
        return this.#listener.restored();
      case "cancelled":
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
    // What ended the worker is not run again by itself.
    this.#running = null;
    if (++this.#crashes <= 2) this.#renew(message);
    else this.#drop(message);
    this.#listener.crashed(message);
  }

  /** Tries once more with a new worker, where crash after crash has left none. */
  revive() {
    if (this.#crashes <= 2) return;
    this.#crashes = 0;
    this.#renew("started again");
  }

  /** Another worker in the place of this one. @param {string} why */
  #renew(why) {
    this.#drop(why);
    this.#worker = this.#start();
    void this.#give(this.#recordings);
    // Should it end this worker, too, it is not made again.
    [this.#restoring, this.#good] = [this.#good, null];
    if (this.#restoring) this.#worker.postMessage({ ...this.#restoring, quiet: true, select: this.#selected });
    // Asked for after the cancel that was not heard.
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

/** A worker that has the core; the page says which script it begins with. */
function another() {
  const made = new Worker(/** @type {string} */ (byId("main").dataset.worker), { type: "module" });
  compiled().then(
    (module) => made.postMessage({ module }),
    // What goes wrong with the core is told by who waits for the charts.
    () => {},
  );
  return made;
}

/** Lets `Dropped` pass in silence and everything else through. @param {unknown} error */
export function unlessDropped(error) {
  if (!(error instanceof Dropped)) throw error;
}
