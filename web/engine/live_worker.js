/**
 * The worker that has a port: the host of a real device, or the device of a real host. It reads and writes; what is said and
 * when, the core decides (LIVE H1, H3, H4). STOP comes first of all.
 *
 * In: first of all {module}, the compiled code; {judge}, a scenario, for {facts}; {stream, readable, writable, stop} to send its
 * ticks, or STOP alone; {serve, readable, writable} to be its controllers; {stop}; {end}. Raw packets go without replies, and
 * their stop is that no more are sent.
 * Out: {facts}; while it has the port {state} and {rows}; {reported} or {recorded} at the end; {closed} when both streams are;
 * {error} where nothing began, or the core failed: what had the port has given it back, and this worker is of no use any more.
 */
import init, * as core from "../pkg-tools/stepscope_wasm.js";
import { awaitModule, fatal, text } from "./judging.js";

/** How much later than on the line a reply may come, in ms: what the system and the adapter add, and the page's window, through which
 * its port's streams go. */
const SLACK_MS = 100;
/** How late the model may be before its clock is set back, in ms. */
const LAG_MS = 50;
/** How long a port may take no bytes, beyond the line's own time, in ms. */
const WRITE_MS = 2000;
/** Least time between two reports, in ms. */
const REPORT_MS = 100;
/** Longest rest of a model that nobody talks to, in ms. */
const IDLE_MS = 5;
/** Shorter rests than a timer keeps are passed by turns of the worker, in ms. */
const TIMER_MS = 5;
/** How long the model runs without a look at what came, in ms. */
const TURN_MS = 10;
/** Bytes of replies that wait for a host that does not read; then it misses further ones, as it would of a real line. */
const MAX_WAITING = 1 << 16;
/** Bits of a byte on the line. */
const BYTE_BITS = 10;

const { provide, ready } = awaitModule(init);
/** What ends a rest early. */
let wake = () => {};
/** What is asked of what has the port. */
let asked = { stop: false, end: false };

const turn = new MessageChannel();
/** @type {() => void} */
let turned = () => {};
turn.port1.onmessage = () => turned();

/** Rests so long, or until there is something to do. @param {number} ms @returns {Promise<void>} */
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
 * A port's two streams: what comes is handed on at once, with its time.
 * @param {{readable: ReadableStream<Uint8Array>, writable: WritableStream<Uint8Array>}} streams
 * @param {(bytes: Uint8Array) => void | Promise<void>} hear Reading goes on when it is done.
 */
function openPort({ readable, writable }, hear) {
  const reader = readable.getReader();
  const writer = writable.getWriter();
  const port = {
    /** Why it is lost; empty while it is there. */
    lost: "",
    /** @param {unknown} error */
    lose(error) {
      port.lost ||= text(error) || "the port is lost";
      wake();
    },
    /** Bytes that wait to be written. */
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
    /** Writes, and knows when the system has taken it. @param {Uint8Array} bytes @param {number} baud */
    async send(bytes, baud) {
      const within = WRITE_MS + (1000 * BYTE_BITS * bytes.length) / baud;
      let timer = 0;
      const late = new Promise((_, reject) => {
        timer = setTimeout(() => reject(new Error("the port takes no bytes")), within);
      });
      await Promise.race([port.write(bytes), late]).catch(port.lose);
      clearTimeout(timer);
    },
    /** Gives the port back, whatever becomes of the work with it. @param {() => Promise<void>} work */
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
      if (done) throw new Error("the port was closed at its other end");
      const heard = hear(value);
      wake();
      await heard;
    }
  };
  read().catch(port.lose);
  return port;
}

/** Reports now and then. @param {() => void} report */
function everySoOften(report) {
  let told = 0;
  return () => {
    if (performance.now() - told < REPORT_MS) return;
    told = performance.now();
    report();
  };
}

/** The host of a device. @param {{stream: string, readable: ReadableStream, writable: WritableStream, stop: boolean}} order */
async function stream({ stream: json, stop, ...streams }) {
  if (core.live_is_raw(json)) return streamRaw(json, stop, streams);
  const host = new core.LiveHost(json, SLACK_MS);
  const began = performance.now();
  const now = () => performance.now() - began;
  const baud = host.baud();
  const port = openPort(streams, (bytes) => host.hear(bytes, now()));
  let stopped = false;
  asked = { stop, end: false };
  const report = () => postMessage({ state: host.state(), rows: host.rows() });
  const tell = everySoOften(report);
  await port.use(async () => {
    while (port.lost === "" && !host.is_over()) {
      if (asked.stop && !stopped) {
        stopped = true;
        host.stop(now());
      }
      const bytes = host.poll(now());
      if (bytes) {
        await port.send(bytes, baud);
        host.sent(now());
      }
      tell();
      // What was asked while it was written is not slept over.
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
  // What is heard answers nothing.
  const port = openPort(streams, () => {});
  asked = { stop, end: false };
  const report = () => postMessage({ state: host.state() });
  const tell = everySoOften(report);
  await port.use(async () => {
    while (port.lost === "" && !asked.stop && !host.is_over()) {
      const at = now();
      const bytes = host.packet(at);
      if (bytes) {
        // What was given to the port counts as written; one that is lost takes nothing.
        await port.send(bytes, baud);
        if (port.lost === "") host.written(at);
      } else await rest(host.wait(at));
      tell();
    }
    report();
    const { lost } = port;
    const stopped = asked.stop && !host.is_over();
    postMessage({ reported: { raw: host.report(stopped, now()), lost, stopped, ms: now() } });
    host.free();
  });
}

/** The device of a host. @param {{serve: string, readable: ReadableStream, writable: WritableStream}} order */
async function serve({ serve: json, ...streams }) {
  const device = new core.LiveDevice(json, LAG_MS, Date.now());
  const began = performance.now();
  const now = () => performance.now() - began;
  /** What was read and waits for the line. @type {{bytes: Uint8Array, at: number, taken: () => void} | null} */
  let heard = null;
  const hear = (/** @type {Uint8Array} */ bytes) =>
    new Promise((/** @type {(value: void) => void} */ taken) => {
      heard = { bytes, at: now(), taken };
    });
  const port = openPort(streams, hear);
  const take = () => {
    if (!heard) return;
    const { bytes, at, taken } = heard;
    const rest = bytes.subarray(device.receive(bytes, at));
    heard = rest.length > 0 ? { bytes: rest, at: now(), taken } : null;
    if (!heard) taken();
  };
  let missed = 0;
  asked = { stop: false, end: false };
  const report = () => postMessage({ state: { ...device.state(), missed } });
  const tell = everySoOften(report);
  const turnRound = () => {
    const behind = device.round(now());
    const replies = device.replies(now());
    if (port.waiting + replies.length > MAX_WAITING) missed += replies.length;
    else if (replies.length > 0) port.write(replies);
    return behind;
  };
  await port.use(async () => {
    while (port.lost === "" && !asked.end) {
      const since = now();
      let behind = turnRound();
      while (behind && now() - since < TURN_MS) behind = turnRound();
      // What was read does not come before its time.
      if (!behind) take();
      tell();
      await rest(behind ? 0 : Math.min(IDLE_MS, device.wait()));
    }
    report();
    const times = new Blob([device.times()], { type: "application/json" });
    postMessage({ recorded: { ...device.recording(), ...device.state(), times, missed, lost: port.lost } });
    device.free();
  });
}

/** What a host, and a device, of a scenario would be; or why there is none. @param {string} json */
function facts(json) {
  /** @param {() => {baud: () => number, margin_ms?: () => number, free: () => void, state: () => any}} make */
  const look = (make) => {
    try {
      const made = make();
      const found = { why: "", baud: made.baud(), margin_ms: made.margin_ms?.() ?? 0, state: made.state() };
      made.free();
      return found;
    } catch (error) {
      if (fatal(error)) throw error;
      return { why: text(error), baud: 0, margin_ms: 0, state: null };
    }
  };
  return {
    stream: look(() => (core.live_is_raw(json) ? new core.LiveRawHost(json) : new core.LiveHost(json, SLACK_MS))),
    serve: look(() => new core.LiveDevice(json, LAG_MS, Date.now())),
  };
}

self.onmessage = async ({ data }) => {
  if ("module" in data) return provide(data.module);
  if ("stream" in data === false && "serve" in data === false && "judge" in data === false) {
    Object.assign(asked, data);
    return wake();
  }
  try {
    await ready;
    if ("judge" in data) return postMessage({ facts: facts(data.judge) });
    await ("stream" in data ? stream(data) : serve(data));
    postMessage({ closed: true });
  } catch (error) {
    // Where nothing began nobody has them yet.
    await Promise.allSettled([data.readable?.cancel(), data.writable?.abort()]);
    postMessage({ error: text(error) });
  }
};
