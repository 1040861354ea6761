/** Additional workers for long requests, which run in parallel. */
import { byId } from "../dom.js";
import { compiled } from "./wasm.js";

/** Maximum workers per request. */
const MAX_WORKERS = 4;
/** Idle workers are terminated after this time, in ms, to free memory. */
const IDLE_MS = 20_000;
/** A canceled worker that has not finished its piece after this time is terminated, in ms. */
const CANCEL_MS = 300;

export class WorkerPool {
  /** Idle workers. @type {Worker[]} */
  #idle = [];
  #idleTimer = 0;
  /** Aborts the newest request of each slot. @type {Map<string, AbortController>} */
  #requests = new Map();
  #Dropped;
  #missing;

  /**
   * @param {typeof import("./request_slots.js").Dropped} Dropped  Rejects requests that are no longer needed.
   * @param {string} missing  Error if the code cannot be fetched.
   */
  constructor(Dropped, missing) {
    this.#Dropped = Dropped;
    this.#missing = missing;
  }

  /** See `Engine`. @param {string} method @param {any[][]} pieces @param {AbortSignal} signal @param {(at: number, reply: any) => void} [onReply] @returns {Promise<any[]>} */
  async distribute(method, pieces, signal, onReply = () => {}) {
    /** @type {any[]} */
    const replies = Array(pieces.length);
    let next = 0;
    const run = async () => {
      const worker = this.#idle.pop() ?? startWorker(this.#missing);
      try {
        while (next < pieces.length) {
          const at = next++;
          replies[at] = await this.#call(worker, method, pieces[at], signal);
          onReply(at, replies[at]);
        }
        this.#release(worker);
      } catch (error) {
        next = pieces.length;
        const timer = setTimeout(() => worker.terminate(), error instanceof this.#Dropped ? CANCEL_MS : 0);
        worker.onmessage = ({ data }) => {
          clearTimeout(timer);
          if ("value" in data || "error" in data) this.#release(worker);
          else worker.terminate();
        };
        throw error;
      }
    };
    await Promise.all(
      Array.from({ length: Math.min(MAX_WORKERS, navigator.hardwareConcurrency || 1, pieces.length) }, run),
    );
    return replies;
  }

  /** See `Engine`. @param {string} slot @param {string} method @param {any[]} args @returns {Promise<any>} */
  async compute(slot, method, args) {
    this.#requests.get(slot)?.abort();
    const controller = new AbortController();
    this.#requests.set(slot, controller);
    const [reply] = await this.distribute(method, [args], controller.signal);
    return reply;
  }

  /** See `Engine`. @template T @param {(request: (method: "open" | "of", ...args: any[]) => Promise<any>) => Promise<T>} work @returns {Promise<T>} */
  async session(work) {
    const worker = this.#idle.pop() ?? startWorker(this.#missing);
    const { signal } = new AbortController();
    try {
      const result = await work((method, ...args) => this.#call(worker, method, args, signal));
      this.#release(worker);
      return result;
    } catch (error) {
      worker.terminate();
      throw error;
    }
  }

  /** Makes a worker available for the next request. @param {Worker} worker */
  #release(worker) {
    this.#idle.push(worker);
    clearTimeout(this.#idleTimer);
    this.#idleTimer = window.setTimeout(() => {
      for (const idle of this.#idle.splice(0)) idle.terminate();
    }, IDLE_MS);
  }

  /** One request to a worker. @param {Worker} worker @param {string} method @param {any[]} args @param {AbortSignal} signal @returns {Promise<any>} */
  #call(worker, method, args, signal) {
    return new Promise((resolve, reject) => {
      const drop = () => reject(new this.#Dropped(method));
      if (signal.aborted) return drop();
      signal.addEventListener("abort", drop, { once: true });
      worker.onerror = (event) => reject(new Error(event.message || "the engine could not be loaded"));
      worker.onmessage = ({ data }) => {
        signal.removeEventListener("abort", drop);
        if ("value" in data) resolve(data.value);
        else reject(new Error(data.error ?? data.message));
      };
      worker.postMessage({ id: 0, method, args });
    });
  }
}

/** A worker with the tools. @param {string} missing */
function startWorker(missing) {
  const worker = new Worker(/** @type {string} */ (byId("main").dataset.studyWorker), { type: "module" });
  compiled().then(
    (module) => worker.postMessage({ module }),
    () => worker.dispatchEvent(new ErrorEvent("error", { message: missing })),
  );
  return worker;
}
