/** Talks to the worker with a real port (live_worker.js): opens the selected port and transfers it. */
import { byId } from "../dom.js";
import { compiled } from "./wasm.js";

/**
 * @typedef {{why: string, baud: number, margin_ms: number, state: any}} Role  `why`: why it is not available; `margin_ms`: how late the page may be before the queue of the device is empty.
 * @typedef {{stream: Role, serve: Role}} Facts
 * @typedef {{at_ms: number, controller: number, kind: string, reply: string | null, state: string | null, ticks_done: number | null,
 *   delay_ms: number | null, model_ms: number | null, difference: string | null}} Exchange
 * @typedef {{text: string, accepted: number, done: number, ticks: number, repeats: number, naks: number}} Standing
 * @typedef {{state: string, ticks_done: number | null, went: number[] | null}} End
 * @typedef {{controller: number, address: number, ticks: number, device: End | null, model: End | null}} EndPair
 * @typedef {{text: string, sent: number, packets: number, stood: number, left_ms: number}} RawReport  `stood`: ticks before which the motor stopped; `left_ms`: remaining time of the queue.
 * @typedef {{lost: string, stopped: boolean, ms: number}} Ended
 * @typedef {{text: string, verified: boolean, why: string | null, stop_acknowledged: boolean, ends: EndPair[], difference: string | null,
 *   raw?: undefined} & Ended} ReportedFramed
 * @typedef {ReportedFramed | ({raw: RawReport} & Ended)} Reported
 * @typedef {{seconds: number, curves_from: number, received: number, replies: number, latest_ms: number, set_backs: number, set_back_ms: number,
 *   records_all: boolean, missed: number, controllers: {state: string | null, queued: number | null, queue_depth: number, positions: number[],
 *   faults: string[], ticks_done: number, curves: number[][]}[]}} Served
 * @typedef {Served & {scenario: string, digests: string[], why: string | null, whole: boolean, lost: string, times: Blob}} Recorded
 * @typedef {{state?: any, rows?: Exchange[], reported?: Reported, recorded?: Recorded, closed?: true, stuck?: boolean, error?: string, facts?: Facts}} LiveEvent  `closed`: the port is closed, or stuck.
 */

/** Maximum time to close a port, in ms; STOP is sent until it is confirmed. */
const PATIENCE_MS = 3000;
/** Maximum time to open a port, in ms. */
const OPEN_MS = 20_000;
/** Interval of checks whether the worker has released the streams, in ms. */
const POLL_MS = 2;
/** Buffer of the port, in bytes. */
const BUFFER = 1 << 16;

/** Web Serial, if the browser supports it on this page. @returns {any} */
export const serial = () => /** @type {any} */ (navigator).serial;

/** Whether the browser can transfer streams to a worker. */
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

/** Closes a port after the worker, and returns whether it could. The streams stay locked for a moment. @param {any} port */
async function closePort(port) {
  const end = performance.now() + PATIENCE_MS;
  while (port.readable?.locked || port.writable?.locked) {
    if (performance.now() > end) return false;
    await rest(POLL_MS);
  }
  // A lost port is already closed.
  const closed = port.close().then(
    () => true,
    () => true,
  );
  return Promise.race([closed, rest(PATIENCE_MS).then(() => false)]);
}

/** @param {(event: LiveEvent) => void} notify */
export function openLive(notify) {
  /** A failed worker is replaced on demand. @type {Worker | null} */
  let worker = null;
  /** The port of the worker. @type {any} */
  let open = null;
  /** Number of failures and closings, to detect an obsolete open port. */
  let ends = 0;
  /** Ends the wait for the port. */
  let left = () => {};
  /** @type {Promise<void>} */
  let gone = Promise.resolve();

  function begin() {
    const started = new Worker(/** @type {string} */ (byId("main").dataset.liveWorker), { type: "module" });
    /** @param {string} error */
    const fail = async (error) => {
      if (worker !== started) return;
      worker = null;
      ends += 1;
      started.terminate();
      notify({ error });
      if (!open) return;
      const stuck = !(await closed());
      left();
      notify({ closed: true, stuck });
    };
    started.onerror = (event) => fail(event.message || "this part of the page could not be loaded");
    started.onmessage = async ({ data }) => {
      if (data.error) return fail(data.error);
      if (data.closed) {
        data.stuck = !(await closed());
        left();
      }
      notify(data);
    };
    compiled("tools").then(
      (module) => started.postMessage({ module }),
      (error) => fail(`this part of the page could not be loaded: ${error.message}`),
    );
    return started;
  }

  /** @param {object} request @param {Transferable[]} [transferred] */
  function post(request, transferred = []) {
    worker ??= begin();
    worker.postMessage(request, transferred);
  }

  /** Closes an open port; returns whether none is left open. */
  async function closed() {
    const port = open;
    open = null;
    return port === null || (await closePort(port));
  }

  /** Whether STOP was pressed since the stream began. */
  let stopped = false;

  /** Opens the port and transfers its streams. @param {any} port @param {number} baudRate @param {() => object} request */
  async function transfer(port, baudRate, request) {
    const since = ends;
    let isOpen = false;
    const opening = port.open({ baudRate, bufferSize: BUFFER }).then(async () => {
      isOpen = true;
      if (ends === since) {
        open = port;
        return;
      }
      // Another port may be open by now.
      if (!(await closePort(port)) && !open) notify({ closed: true, stuck: true });
      throw new Error("its use has ended.");
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
      post({ ...request(), readable, writable }, [readable, writable]);
    } catch (error) {
      if (!(await closed())) notify({ closed: true, stuck: true });
      throw error;
    }
  }

  return {
    /** @param {string} json */
    validate: (json) => post({ validate: json }),
    /** @param {any} port @param {number} baud @param {string} json @param {boolean} stop  Whether to send only STOP. */
    stream(port, baud, json, stop) {
      stopped = stop;
      return transfer(port, baud, () => ({ stream: json, stop: stopped }));
    },
    /** @param {any} port @param {number} baud @param {string} json */
    serve: (port, baud, json) => transfer(port, baud, () => ({ serve: json })),
    stop() {
      stopped = true;
      worker?.postMessage({ stop: true });
    },
    end: () => worker?.postMessage({ end: true }),
    /** Stops the worker and closes the port. `inTime`: it stopped in time; `free`: no port is left open. */
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
