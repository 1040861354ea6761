/** The interface to the worker with a real port (live_worker.js). The page opens the selected port and transfers its streams. */
import { byId } from "../dom.js";
import { sleep } from "./sleep.js";
import { compiled } from "./wasm.js";

/**
 * @typedef {{why: string, baud: number, margin_ms: number, state: any}} Role  `why`: why it is not available; `margin_ms`: maximum delay of the page before the queue of the device is empty.
 * @typedef {{stream: Role, serve: Role}} Facts
 * @typedef {{at_ms: number, controller: number, kind: string, reply: string | null, state: string | null, ticks_done: number | null,
 *   delay_ms: number | null, model_ms: number | null, difference: string | null}} Exchange
 * @typedef {{text: string, accepted: number, done: number, ticks: number, repeats: number, naks: number}} Standing
 * @typedef {{state: string, ticks_done: number | null, went: number[] | null}} End
 * @typedef {{controller: number, address: number, ticks: number, device: End | null, model: End | null}} EndPair
 * @typedef {{text: string, sent: number, packets: number, stood: number, left_ms: number}} RawReport  `stood`: number of ticks before which the motor stopped; `left_ms`: remaining time of the queue.
 * @typedef {{lost: string, stopped: boolean, ms: number}} Ended
 * @typedef {{text: string, verified: boolean, why: string | null, stop_acknowledged: boolean, ends: EndPair[], difference: string | null,
 *   raw?: undefined} & Ended} ReportedFramed
 * @typedef {ReportedFramed | ({raw: RawReport} & Ended)} Reported
 * @typedef {{seconds: number, curves_from: number, received: number, replies: number, max_delay_ms: number, set_backs: number, set_back_ms: number,
 *   records_all: boolean, missed: number, controllers: {state: string | null, queued: number | null, queue_depth: number, positions: number[],
 *   faults: string[], ticks_done: number, curves: number[][]}[]}} Served
 * @typedef {Served & {scenario: string, digests: string[], why: string | null, whole: boolean, lost: string, times: Blob}} Recorded
 * @typedef {{state?: any, rows?: Exchange[], reported?: Reported, recorded?: Recorded, closed?: true, stuck?: boolean, error?: string, facts?: Facts}} LiveEvent  `closed`: the port is closed, or stuck.
 */

/** Maximum time to close a port, in ms; STOP is sent until it is confirmed. */
const CLOSE_MS = 3000;
/** Maximum time to open a port, in ms. */
const OPEN_MS = 20_000;

/** The error of a port that opened after the dialog was left. */
export class PortLeft extends Error {}
/** Interval of checks whether the worker has released the streams, in ms. */
const POLL_MS = 2;
/** Buffer of the port, in bytes. */
const BUFFER = 1 << 16;

/** Web Serial, if the browser supports it on this page. @returns {any} */
export const serial = () => /** @type {any} */ (navigator).serial;

/** Whether the browser can transfer streams to a worker. */
export function canTransferStreams() {
  const { readable, writable } = new TransformStream();
  try {
    structuredClone([readable, writable], { transfer: [readable, writable] });
    return true;
  } catch {
    return false;
  }
}

/** Closes a port; returns whether that succeeded. The streams stay locked until the worker has released them. @param {any} port */
async function closePort(port) {
  const end = performance.now() + CLOSE_MS;
  while (port.readable?.locked || port.writable?.locked) {
    if (performance.now() > end) return false;
    await sleep(POLL_MS);
  }
  // A lost port is already closed.
  const closed = port.close().then(
    () => true,
    () => true,
  );
  return Promise.race([closed, sleep(CLOSE_MS).then(() => false)]);
}

/** @param {(event: LiveEvent) => void} notify */
export function openLive(notify) {
  /** Started on demand, also after a failure. @type {Worker | null} */
  let worker = null;
  /** The open port. @type {any} */
  let openPort = null;
  /** Number of failures and closings; a port that opens after one of them is closed again. */
  let endCount = 0;
  /** Resolves `released`. */
  let markReleased = () => {};
  /** Resolves when the worker has closed the port. @type {Promise<void>} */
  let released = Promise.resolve();

  function start() {
    const started = new Worker(/** @type {string} */ (byId("main").dataset.liveWorker), { type: "module" });
    /** @param {string} error */
    const fail = async (error) => {
      if (worker !== started) return;
      worker = null;
      endCount += 1;
      started.terminate();
      notify({ error });
      if (!openPort) return;
      const stuck = !(await closeOpenPort());
      markReleased();
      notify({ closed: true, stuck });
    };
    started.onerror = (event) => fail(event.message || "this part of the page could not be loaded");
    started.onmessage = async ({ data }) => {
      if (data.error) return fail(data.error);
      if (data.closed) {
        data.stuck = !(await closeOpenPort());
        markReleased();
      }
      notify(data);
    };
    compiled().then(
      (module) => started.postMessage({ module }),
      (error) => fail(`this part of the page could not be loaded: ${error.message}`),
    );
    return started;
  }

  /** @param {object} request @param {Transferable[]} [transferred] */
  function post(request, transferred = []) {
    worker ??= start();
    worker.postMessage(request, transferred);
  }

  /** Closes an open port; returns whether none is left open. */
  async function closeOpenPort() {
    const port = openPort;
    openPort = null;
    return port === null || (await closePort(port));
  }

  /** Whether STOP was requested since the stream began. */
  let stopRequested = false;

  /** Opens the port and transfers its streams. @param {any} port @param {number} baudRate @param {() => object} request */
  async function transfer(port, baudRate, request) {
    const countBefore = endCount;
    let isOpen = false;
    const opening = port.open({ baudRate, bufferSize: BUFFER }).then(async () => {
      isOpen = true;
      if (endCount === countBefore) {
        openPort = port;
        return;
      }
      // Another port may be open by now.
      if (!(await closePort(port)) && !openPort) notify({ closed: true, stuck: true });
      throw new PortLeft("The port was closed because the dialog was left.");
    });
    const late = sleep(OPEN_MS).then(() => {
      if (isOpen) return;
      endCount += 1;
      throw new Error(`the port did not open within ${OPEN_MS / 1000} s.`);
    });
    await Promise.race([opening, late]);
    released = new Promise((resolve) => {
      markReleased = resolve;
    });
    const { readable, writable } = port;
    try {
      post({ ...request(), readable, writable }, [readable, writable]);
    } catch (error) {
      if (!(await closeOpenPort())) notify({ closed: true, stuck: true });
      throw error;
    }
  }

  return {
    /** @param {string} json */
    validate: (json) => post({ validate: json }),
    /** @param {any} port @param {number} baud @param {string} json @param {boolean} stop  Whether to send only STOP. */
    stream(port, baud, json, stop) {
      stopRequested = stop;
      return transfer(port, baud, () => ({ stream: json, stop: stopRequested }));
    },
    /** @param {any} port @param {number} baud @param {string} json */
    serve: (port, baud, json) => transfer(port, baud, () => ({ serve: json })),
    stop() {
      stopRequested = true;
      worker?.postMessage({ stop: true });
    },
    end: () => worker?.postMessage({ end: true }),
    /** Stops the worker and closes the port. `inTime`: it stopped in time; `free`: no port is left open. */
    async close() {
      endCount += 1;
      let inTime = true;
      if (openPort) {
        worker?.postMessage({ stop: true, end: true });
        inTime = await Promise.race([released.then(() => true), sleep(CLOSE_MS).then(() => false)]);
      }
      worker?.terminate();
      worker = null;
      return { inTime, free: await closeOpenPort() };
    },
  };
}
