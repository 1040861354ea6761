/**
 * Further workers, which answer long questions beside each other, as many as the machine has room for. Neither the run nor
 * the views' questions wait for them.
 */
import { byId } from "../dom.js";
import { compiled } from "./wasm.js";

/** Most further workers of one question. */
const MAX_FURTHER = 4;
/** A further worker that is not needed ends after this time, in ms: it holds memory. */
const IDLE_MS = 20_000;
/** And one whose piece was left off, if it does not come to the piece's end in this time. */
const LEFT_MS = 300;

export class Further {
  /** Workers with nothing to do. @type {Worker[]} */
  #idle = [];
  #resting = 0;
  /** The newest question of each slot. @type {Map<string, AbortController>} */
  #considered = new Map();
  #Dropped;
  #missing;

  /**
   * @param {typeof import("./engine.js").Dropped} Dropped  Thrown into questions that no longer matter.
   * @param {string} missing  What is told where the study's code could not be fetched.
   */
  constructor(Dropped, missing) {
    this.#Dropped = Dropped;
    this.#missing = missing;
  }

  /** As the engine's. @param {string} method @param {any[][]} pieces @param {AbortSignal} signal @param {(at: number, answer: any) => void} [onAnswer] @returns {Promise<any[]>} */
  async distribute(method, pieces, signal, onAnswer = () => {}) {
    /** @type {any[]} */
    const answers = Array(pieces.length);
    let next = 0;
    const help = async () => {
      const worker = this.#idle.pop() ?? another(this.#missing);
      try {
        while (next < pieces.length) {
          const at = next++;
          answers[at] = await this.#call(worker, method, pieces[at], signal);
          onAnswer(at, answers[at]);
        }
        this.#rest(worker);
      } catch (error) {
        next = pieces.length;
        const timer = setTimeout(() => worker.terminate(), error instanceof this.#Dropped ? LEFT_MS : 0);
        worker.onmessage = ({ data }) => {
          clearTimeout(timer);
          if ("value" in data || "error" in data) this.#rest(worker);
          else worker.terminate();
        };
        throw error;
      }
    };
    await Promise.all(
      Array.from({ length: Math.min(MAX_FURTHER, navigator.hardwareConcurrency || 1, pieces.length) }, help),
    );
    return answers;
  }

  /** As the engine's. @param {string} slot @param {string} method @param {any[]} args @returns {Promise<any>} */
  async consider(slot, method, args) {
    this.#considered.get(slot)?.abort();
    const own = new AbortController();
    this.#considered.set(slot, own);
    const [answer] = await this.distribute(method, [args], own.signal);
    return answer;
  }

  /** As the engine's. @template T @param {(ask: (method: "open" | "of", ...args: any[]) => Promise<any>) => Promise<T>} work @returns {Promise<T>} */
  async session(work) {
    const worker = this.#idle.pop() ?? another(this.#missing);
    const { signal } = new AbortController();
    try {
      const result = await work((method, ...args) => this.#call(worker, method, args, signal));
      this.#rest(worker);
      return result;
    } catch (error) {
      worker.terminate();
      throw error;
    }
  }

  /** Keeps a further worker for the next question that comes soon. @param {Worker} worker */
  #rest(worker) {
    this.#idle.push(worker);
    clearTimeout(this.#resting);
    this.#resting = window.setTimeout(() => {
      for (const each of this.#idle.splice(0)) each.terminate();
    }, IDLE_MS);
  }

  /** One question to a worker. @param {Worker} worker @param {string} method @param {any[]} args @param {AbortSignal} signal @returns {Promise<any>} */
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

/** A worker that has the tools; the page says which script it begins with. @param {string} missing */
function another(missing) {
  const made = new Worker(/** @type {string} */ (byId("main").dataset.studyWorker), { type: "module" });
  compiled("tools").then(
    (module) => made.postMessage({ module }),
    () => made.dispatchEvent(new ErrorEvent("error", { message: missing })),
  );
  return made;
}
