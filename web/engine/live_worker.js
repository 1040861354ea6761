/**
 * The worker with a port: the host of a real device, or the device of a real host. The core decides what is sent and when
 * (LIVE H1, H3, H4).
 *
 * In: first {module}, the compiled code; {validate}, a scenario, replied with {facts}; {stream, readable, writable, stop} to
 * send its ticks, or only STOP; {serve, readable, writable} to be its controllers; {stop}; {end}.
 * Out: {facts}; {state} and {rows} while the port is open; {reported} or {recorded} at the end; {closed}; {error}, after which
 * the worker cannot be used.
 */
import init, * as core from "../pkg/stepscope_wasm.js";
import { errorMessage } from "../state/error_message.js";
import { openPort } from "./live_port.js";
import { awaitModule, isFatal } from "./worker_common.js";

/** Additional delay of a reply by the system, the adapter and the page, in ms. */
const SLACK_MS = 100;
/** If the model is later than this, its clock is set back, in ms. */
const LAG_MS = 50;
/** Minimum time between two reports, in ms. */
const REPORT_MS = 100;
/** Maximum pause of an idle model, in ms. */
const IDLE_MS = 5;
/** Shorter pauses use messages, because timers are too coarse for them, in ms. */
const TIMER_MS = 5;
/** Maximum time that the model runs before messages are read, in ms. */
const RUN_MS = 10;
/** Maximum bytes of unread replies; more are lost, as on a real line. */
const MAX_WAITING = 1 << 16;

const { provide, ready } = awaitModule(init);
/** Ends a pause early. */
let wake = () => {};
/** What the page has requested. */
let requested = { stop: false, end: false };

const channel = new MessageChannel();
/** @type {() => void} */
let onChannelMessage = () => {};
channel.port1.onmessage = () => onChannelMessage();

/** Pauses until `wake` or a timeout. @param {number} ms @returns {Promise<void>} */
function pause(ms) {
  return new Promise((resolve) => {
    const timer = ms >= TIMER_MS && ms < Number.POSITIVE_INFINITY ? setTimeout(() => wake(), ms) : 0;
    wake = () => {
      clearTimeout(timer);
      onChannelMessage = wake = () => {};
      resolve();
    };
    if (ms >= TIMER_MS) return;
    onChannelMessage = wake;
    channel.port2.postMessage(null);
  });
}

/** Limits the rate of reports. @param {() => void} report */
function throttled(report) {
  let reported = 0;
  return () => {
    if (performance.now() - reported < REPORT_MS) return;
    reported = performance.now();
    report();
  };
}

/** The host of a device. @param {{stream: string, readable: ReadableStream, writable: WritableStream, stop: boolean}} request */
async function stream({ stream: json, stop, ...streams }) {
  if (core.live_is_raw(json)) return streamRaw(json, stop, streams);
  const host = new core.LiveHost(json, SLACK_MS);
  const startTime = performance.now();
  const now = () => performance.now() - startTime;
  const baud = host.baud();
  const port = openPort(
    streams,
    (bytes) => host.receive(bytes, now()),
    () => wake(),
  );
  let stopped = false;
  requested = { stop, end: false };
  const report = () => postMessage({ state: host.state(), rows: host.rows() });
  const reportThrottled = throttled(report);
  await port.use(async () => {
    while (port.lost === "" && !host.is_over()) {
      if (requested.stop && !stopped) {
        stopped = true;
        host.stop(now());
      }
      const bytes = host.poll(now());
      if (bytes) {
        await port.send(bytes, baud);
        host.sent(now());
      }
      reportThrottled();
      // A request may have arrived during the write.
      if (!bytes && port.lost === "" && !host.is_over()) await pause(host.wait(now()));
    }
    report();
    const reported = host.report(port.lost === "" ? undefined : `the port is lost: ${port.lost}`);
    postMessage({ reported: { ...reported, lost: port.lost, stopped, ms: now() } });
    host.free();
  });
}

/** The host of a raw line. @param {string} json @param {boolean} stop @param {{readable: ReadableStream, writable: WritableStream}} streams */
async function streamRaw(json, stop, streams) {
  const host = new core.LiveRawHost(json);
  const startTime = performance.now();
  const now = () => performance.now() - startTime;
  const baud = host.baud();
  // Received bytes are ignored.
  const port = openPort(
    streams,
    () => {},
    () => wake(),
  );
  requested = { stop, end: false };
  const report = () => postMessage({ state: host.state() });
  const reportThrottled = throttled(report);
  await port.use(async () => {
    while (port.lost === "" && !requested.stop && !host.is_over()) {
      const at = now();
      const bytes = host.packet(at);
      if (bytes) {
        // Bytes that the port has accepted count as written.
        await port.send(bytes, baud);
        if (port.lost === "") host.written(at);
      } else await pause(host.wait(at));
      reportThrottled();
    }
    report();
    const { lost } = port;
    const stopped = requested.stop && !host.is_over();
    postMessage({ reported: { raw: host.report(stopped, now()), lost, stopped, ms: now() } });
    host.free();
  });
}

/** The device of a host. @param {{serve: string, readable: ReadableStream, writable: WritableStream}} request */
async function serve({ serve: json, ...streams }) {
  const device = new core.LiveDevice(json, LAG_MS, Date.now());
  const startTime = performance.now();
  const now = () => performance.now() - startTime;
  /** Bytes that the model has not accepted yet. @type {{bytes: Uint8Array, at: number, onAccepted: () => void} | null} */
  let received = null;
  const receive = (/** @type {Uint8Array} */ bytes) =>
    new Promise((/** @type {(value: void) => void} */ onAccepted) => {
      received = { bytes, at: now(), onAccepted };
    });
  const port = openPort(streams, receive, () => wake());
  const feedModel = () => {
    if (!received) return;
    const { bytes, at, onAccepted } = received;
    const remaining = bytes.subarray(device.receive(bytes, at));
    received = remaining.length > 0 ? { bytes: remaining, at: now(), onAccepted } : null;
    if (!received) onAccepted();
  };
  let missedReplyBytes = 0;
  requested = { stop: false, end: false };
  const report = () => postMessage({ state: { ...device.state(), missed: missedReplyBytes } });
  const reportThrottled = throttled(report);
  const runRound = () => {
    const behind = device.round(now());
    const replies = device.replies(now());
    if (port.waiting + replies.length > MAX_WAITING) missedReplyBytes += replies.length;
    else if (replies.length > 0) port.write(replies);
    return behind;
  };
  await port.use(async () => {
    while (port.lost === "" && !requested.end) {
      const roundStart = now();
      let behind = runRound();
      while (behind && now() - roundStart < RUN_MS) behind = runRound();
      // The model must not receive bytes before their time.
      if (!behind) feedModel();
      reportThrottled();
      await pause(behind ? 0 : Math.min(IDLE_MS, device.wait()));
    }
    report();
    const times = new Blob([device.times()], { type: "application/json" });
    postMessage({
      recorded: { ...device.verified_recording(), ...device.state(), times, missed: missedReplyBytes, lost: port.lost },
    });
    device.free();
  });
}

/** Properties of the host and the device of a scenario, or why there is none. @param {string} json */
function facts(json) {
  /** @param {() => {baud: () => number, margin_ms?: () => number, free: () => void, state: () => any}} make */
  const describe = (make) => {
    try {
      const role = make();
      const description = { why: "", baud: role.baud(), margin_ms: role.margin_ms?.() ?? 0, state: role.state() };
      role.free();
      return description;
    } catch (error) {
      if (isFatal(error)) throw error;
      return { why: errorMessage(error), baud: 0, margin_ms: 0, state: null };
    }
  };
  return {
    stream: describe(() => (core.live_is_raw(json) ? new core.LiveRawHost(json) : new core.LiveHost(json, SLACK_MS))),
    serve: describe(() => new core.LiveDevice(json, LAG_MS, Date.now())),
  };
}

self.onmessage = async ({ data }) => {
  if ("module" in data) return provide(data.module);
  if ("stream" in data === false && "serve" in data === false && "validate" in data === false) {
    Object.assign(requested, data);
    return wake();
  }
  try {
    await ready;
    if ("validate" in data) return postMessage({ facts: facts(data.validate) });
    await ("stream" in data ? stream(data) : serve(data));
    postMessage({ closed: true });
  } catch (error) {
    // If the port was not opened, its streams are still to be closed.
    await Promise.allSettled([data.readable?.cancel(), data.writable?.abort()]);
    postMessage({ error: errorMessage(error) });
  }
};
