/**
 * The worker with a port: the host of a real device, or the device of a real host. The core decides what is sent and when
 * (LIVE H1, H3, H4).
 *
 * In: {module}, the compiled code, first; {validate}, a scenario, replied with {facts}; {stream, readable, writable, stop} to
 * send its ticks, or only STOP; {serve, readable, writable} to be its controllers; {stop}; {end}.
 * Out: {facts}; {state} and {rows} while the port is open; {reported} or {recorded} at the end; {closed}; {error}, after which
 * the worker cannot be used.
 */
import init, * as core from "../pkg-tools/stepscope_wasm.js";
import { awaitModule, fatal, text } from "./worker_common.js";

/** Additional delay of a reply by the system, the adapter and the page, in ms. */
const SLACK_MS = 100;
/** Maximum lag of the model before its clock is set back, in ms. */
const LAG_MS = 50;
/** Maximum time of a write beyond the line time, in ms. */
const WRITE_MS = 2000;
/** Minimum time between two reports, in ms. */
const REPORT_MS = 100;
/** Maximum pause of an idle model, in ms. */
const IDLE_MS = 5;
/** Shorter pauses use messages, because timers are too coarse, in ms. */
const TIMER_MS = 5;
/** Maximum time of the model before messages are read, in ms. */
const TURN_MS = 10;
/** Maximum bytes of unread replies; more are lost, as on a real line. */
const MAX_WAITING = 1 << 16;
/** Bits of a byte on the line. */
const BYTE_BITS = 10;

const { provide, ready } = awaitModule(init);
/** Ends a pause early. */
let wake = () => {};
/** Requests of the page. */
let requested = { stop: false, end: false };

const turn = new MessageChannel();
/** @type {() => void} */
let turned = () => {};
turn.port1.onmessage = () => turned();

/** Pauses until `wake` or a timeout. @param {number} ms @returns {Promise<void>} */
function rest(ms) {
  return new Promise((resolve) => {
    const timer = ms >= TIMER_MS && ms < Number.POSITIVE_INFINITY ? setTimeout(() => wake(), ms) : 0;
    wake = () => {
      clearTimeout(timer);
      turned = wake = () => {};
      resolve();
    };
    if (ms >= TIMER_MS) return;
    turned = wake;
    turn.port2.postMessage(null);
  });
}

/**
 * The streams of a port.
 * @param {{readable: ReadableStream<Uint8Array>, writable: WritableStream<Uint8Array>}} streams
 * @param {(bytes: Uint8Array) => void | Promise<void>} receive  Reading continues when it is done.
 */
function openPort({ readable, writable }, receive) {
  const reader = readable.getReader();
  const writer = writable.getWriter();
  const port = {
    /** Why it is lost; empty if it is not. */
    lost: "",
    /** @param {unknown} error */
    lose(error) {
      port.lost ||= text(error) || "the port is lost";
      wake();
    },
    /** Bytes to be written. */
    waiting: 0,
    /** @param {Uint8Array} bytes */
    write(bytes) {
      port.waiting += bytes.length;
      const written = writer.write(bytes);
      written.then(() => {
        port.waiting -= bytes.length;
      }, port.lose);
      return written;
    },
    /** Writes, and resolves when the system has accepted it. @param {Uint8Array} bytes @param {number} baud */
    async send(bytes, baud) {
      const within = WRITE_MS + (1000 * BYTE_BITS * bytes.length) / baud;
      let timer = 0;
      const late = new Promise((_, reject) => {
        timer = setTimeout(() => reject(new Error("the port accepts no bytes")), within);
      });
      await Promise.race([port.write(bytes), late]).catch(port.lose);
      clearTimeout(timer);
    },
    /** Closes the port after the work, even after an error. @param {() => Promise<void>} work */
    async use(work) {
      try {
        await work();
      } finally {
        await port.close();
      }
    },
    async close() {
      const closing = port.lost ? writer.abort() : writer.close();
      const late = new Promise((resolve) => setTimeout(resolve, WRITE_MS));
      await Promise.race([Promise.allSettled([reader.cancel(), closing]), late]);
    },
  };
  const read = async () => {
    for (;;) {
      const { value, done } = await reader.read();
      if (done) throw new Error("the other end closed the port");
      const taken = receive(value);
      wake();
      await taken;
    }
  };
  read().catch(port.lose);
  return port;
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
  const began = performance.now();
  const now = () => performance.now() - began;
  const baud = host.baud();
  const port = openPort(streams, (bytes) => host.receive(bytes, now()));
  let stopped = false;
  requested = { stop, end: false };
  const report = () => postMessage({ state: host.state(), rows: host.rows() });
  const reportSometimes = throttled(report);
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
      reportSometimes();
      // A request may have arrived during the write.
      if (!bytes && port.lost === "" && !host.is_over()) await rest(host.wait(now()));
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
  const began = performance.now();
  const now = () => performance.now() - began;
  const baud = host.baud();
  // Received bytes are ignored.
  const port = openPort(streams, () => {});
  requested = { stop, end: false };
  const report = () => postMessage({ state: host.state() });
  const reportSometimes = throttled(report);
  await port.use(async () => {
    while (port.lost === "" && !requested.stop && !host.is_over()) {
      const at = now();
      const bytes = host.packet(at);
      if (bytes) {
        // Bytes given to the port count as written.
        await port.send(bytes, baud);
        if (port.lost === "") host.written(at);
      } else await rest(host.wait(at));
      reportSometimes();
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
  const began = performance.now();
  const now = () => performance.now() - began;
  /** Bytes that wait for the line. @type {{bytes: Uint8Array, at: number, taken: () => void} | null} */
  let received = null;
  const receive = (/** @type {Uint8Array} */ bytes) =>
    new Promise((/** @type {(value: void) => void} */ taken) => {
      received = { bytes, at: now(), taken };
    });
  const port = openPort(streams, receive);
  const take = () => {
    if (!received) return;
    const { bytes, at, taken } = received;
    const rest = bytes.subarray(device.receive(bytes, at));
    received = rest.length > 0 ? { bytes: rest, at: now(), taken } : null;
    if (!received) taken();
  };
  let missed = 0;
  requested = { stop: false, end: false };
  const report = () => postMessage({ state: { ...device.state(), missed } });
  const reportSometimes = throttled(report);
  const runRound = () => {
    const behind = device.round(now());
    const replies = device.replies(now());
    if (port.waiting + replies.length > MAX_WAITING) missed += replies.length;
    else if (replies.length > 0) port.write(replies);
    return behind;
  };
  await port.use(async () => {
    while (port.lost === "" && !requested.end) {
      const since = now();
      let behind = runRound();
      while (behind && now() - since < TURN_MS) behind = runRound();
      // Bytes are not used before their time.
      if (!behind) take();
      reportSometimes();
      await rest(behind ? 0 : Math.min(IDLE_MS, device.wait()));
    }
    report();
    const times = new Blob([device.times()], { type: "application/json" });
    postMessage({ recorded: { ...device.recording(), ...device.state(), times, missed, lost: port.lost } });
    device.free();
  });
}

/** Properties of the host and the device of a scenario, or why there is none. @param {string} json */
function facts(json) {
  /** @param {() => {baud: () => number, margin_ms?: () => number, free: () => void, state: () => any}} make */
  const describe = (make) => {
    try {
      const end = make();
      const found = { why: "", baud: end.baud(), margin_ms: end.margin_ms?.() ?? 0, state: end.state() };
      end.free();
      return found;
    } catch (error) {
      if (fatal(error)) throw error;
      return { why: text(error), baud: 0, margin_ms: 0, state: null };
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
    // If nothing began, the streams are still here.
    await Promise.allSettled([data.readable?.cancel(), data.writable?.abort()]);
    postMessage({ error: text(error) });
  }
};
