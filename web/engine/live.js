/** Talks to the worker that has a real port (live_worker.js): opens the port that the visitor chose, and gives it away. */
import { byId } from "../dom.js";
import { compiled } from "./wasm.js";

/**
 * @typedef {{why: string, baud: number, margin_ms: number, state: any}} Role  What one would be; why not, where it cannot be. The margin: how late the page may be before the device's queue runs dry.
 * @typedef {{stream: Role, serve: Role}} Facts
 * @typedef {{at_ms: number, controller: number, kind: string, reply: string | null, state: string | null, ticks_done: number | null,
 *   delay_ms: number | null, model_ms: number | null, difference: string | null}} Exchange
 * @typedef {{text: string, accepted: number, done: number, ticks: number, repeats: number, naks: number}} Standing
 * @typedef {{state: string, ticks_done: number | null, went: number[] | null}} End
 * @typedef {{controller: number, address: number, ticks: number, device: End | null, model: End | null}} Beside
 * @typedef {{text: string, sent: number, packets: number, stood: number, left_ms: number}} RawReport  Of packets that nobody answers: before how many ticks the motor must have stood, and how long the device still has ticks to do.
 * @typedef {{lost: string, stopped: boolean, ms: number}} Ended
 * @typedef {{text: string, verified: boolean, why: string | null, stop_acknowledged: boolean, beside: Beside[], difference: string | null,
 *   raw?: undefined} & Ended} ReportedFramed
 * @typedef {ReportedFramed | ({raw: RawReport} & Ended)} Reported
 * @typedef {{seconds: number, curves_from: number, heard: number, replies: number, latest_ms: number, set_backs: number, set_back_ms: number,
 *   records_all: boolean, missed: number, controllers: {state: string | null, queued: number | null, queue_depth: number, positions: number[],
 *   faults: string[], ticks_done: number, curves: number[][]}[]}} Served
 * @typedef {Served & {scenario: string, digests: string[], why: string | null, whole: boolean, lost: string, times: Blob}} Recorded
 * @typedef {{state?: any, rows?: Exchange[], reported?: Reported, recorded?: Recorded, closed?: true, stuck?: boolean, error?: string, facts?: Facts}} Told  Closed: the port is given back, or it is stuck and stays open.
 */

/** How long what has the port may take to give it back, in ms: STOP is sent until it is confirmed. */
const PATIENCE_MS = 3000;
/** How long a port may take to open, in ms. */
const OPEN_MS = 20_000;
/** How often it is looked whether a port's streams have come back from the worker, in ms. */
const LOOK_MS = 2;
/** Bytes that the system keeps for the page. */
const BUFFER = 1 << 16;

/** Web Serial, where this browser has it and gives it to this page. @returns {any} */
export const serial = () => /** @type {any} */ (navigator).serial;

/** Whether this browser moves streams to a worker, as a port's are here. */
export function movesStreams() {
  const { readable, writable } = new TransformStream();
  try {
    structuredClone([readable, writable], { transfer: [readable, writable] });
    return true;
  } catch {
    return false;
  }
}

/** @param {number} ms @returns {Promise<void>} */
const rest = (ms) => new Promise((rested) => setTimeout(rested, ms));

/** Closes a port that the worker has done with, and tells whether it could. What the worker has closed is in use here for a moment
 * more, and a port in use does not close. @param {any} port */
async function closePort(port) {
  const end = performance.now() + PATIENCE_MS;
  while (port.readable?.locked || port.writable?.locked) {
    if (performance.now() > end) return false;
    await rest(LOOK_MS);
  }
  // One that is lost is closed already.
  const closed = port.close().then(
    () => true,
    () => true,
  );
  return Promise.race([closed, rest(PATIENCE_MS).then(() => false)]);
}

/** @param {(told: Told) => void} told */
export function openLive(told) {
  /** One that failed is replaced when it is needed next. @type {Worker | null} */
  let worker = null;
  /** The port that the worker has. @type {any} */
  let open = null;
  /** Ends of what a port may have been opened for: by a failure, or by who closes all. */
  let ends = 0;
  /** Ends the wait for what has the port. */
  let left = () => {};
  /** @type {Promise<void>} */
  let gone = Promise.resolve();

  function begin() {
    const begun = new Worker(/** @type {string} */ (byId("main").dataset.liveWorker), { type: "module" });
    /** Nobody is behind it any more. @param {string} error */
    const fail = async (error) => {
      if (worker !== begun) return;
      worker = null;
      ends += 1;
      begun.terminate();
      told({ error });
      if (!open) return;
      const stuck = !(await closed());
      left();
      told({ closed: true, stuck });
    };
    begun.onerror = (event) => fail(event.message || "this part of the page could not be loaded");
    begun.onmessage = async ({ data }) => {
      if (data.error) return fail(data.error);
      if (data.closed) {
        data.stuck = !(await closed());
        left();
      }
      told(data);
    };
    compiled("tools").then(
      (module) => begun.postMessage({ module }),
      (error) => fail(`this part of the page could not be loaded: ${error.message}`),
    );
    return begun;
  }

  /** @param {object} order @param {Transferable[]} [given] */
  function post(order, given = []) {
    worker ??= begin();
    worker.postMessage(order, given);
  }

  /** Closes the port, if one is open; whether none is left open. */
  async function closed() {
    const port = open;
    open = null;
    return port === null || (await closePort(port));
  }

  /** Whether STOP was pressed since the stream began: also while its port is opened. */
  let stopped = false;

  /** Opens the port and hands its streams to the worker. @param {any} port @param {number} baudRate @param {() => object} order */
  async function give(port, baudRate, order) {
    const since = ends;
    let isOpen = false;
    const opening = port.open({ baudRate, bufferSize: BUFFER }).then(async () => {
      isOpen = true;
      if (ends === since) {
        open = port;
        return;
      }
      // Another port may be in use by now: that one stays.
      if (!(await closePort(port)) && !open) told({ closed: true, stuck: true });
      throw new Error("what it was opened for has ended.");
    });
    const late = rest(OPEN_MS).then(() => {
      if (isOpen) return;
      ends += 1;
      throw new Error("it does not open.");
    });
    await Promise.race([opening, late]);
    gone = new Promise((resolve) => {
      left = resolve;
    });
    const { readable, writable } = port;
    try {
      post({ ...order(), readable, writable }, [readable, writable]);
    } catch (error) {
      if (!(await closed())) told({ closed: true, stuck: true });
      throw error;
    }
  }

  return {
    /** What can be done with a scenario. @param {string} json */
    judge: (json) => post({ judge: json }),
    /** @param {any} port @param {number} baud @param {string} json @param {boolean} stop  Whether STOP is all that is sent. */
    stream(port, baud, json, stop) {
      stopped = stop;
      return give(port, baud, () => ({ stream: json, stop: stopped }));
    },
    /** @param {any} port @param {number} baud @param {string} json */
    serve: (port, baud, json) => give(port, baud, () => ({ serve: json })),
    stop() {
      stopped = true;
      worker?.postMessage({ stop: true });
    },
    end: () => worker?.postMessage({ end: true }),
    /** What has the port stops, gives it back, and ends: whether it did in time, and whether no port is left open. */
    async close() {
      ends += 1;
      let inTime = true;
      if (open) {
        worker?.postMessage({ stop: true, end: true });
        inTime = await Promise.race([gone.then(() => true), rest(PATIENCE_MS).then(() => false)]);
      }
      worker?.terminate();
      worker = null;
      return { inTime, free: await closed() };
    },
  };
}
