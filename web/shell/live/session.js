/** The state of the device dialog, without DOM and port. */
import { outcome } from "./report.js";

/** @typedef {import("../../engine/live.js").Facts} Facts */
/** @typedef {import("../../engine/live.js").Exchange} Exchange */
/** @typedef {import("../../engine/live.js").Reported} Reported */
/** @typedef {import("./roles.js").Role} Role */
/** @typedef {{json: string, title: string, baud: number, raw: boolean, port: any}} Sent  An experiment that is sent to a port. */
/**
 * What stays after the dialog is closed: the selected port, and the last transfer that may not have ended. STOP uses the settings
 * of that transfer.
 * @typedef {{port: any, unsettled: Sent | null}} Device
 */
/** @typedef {{action: "none" | "begin" | "end" | "stop", text: string}} StopPress  The effect of a press of STOP. */

/** What a device does when the page stops sending. */
export const RUNS_DRY =
  "The device executes its queue and stops with UNDERRUN. Switch off its power if it must not move.";

export class LiveSession {
  /** The available roles for the experiment; null until they are known. @type {Facts | null} */
  facts = null;
  /** The experiment of `facts`. */
  json = "";
  /** Why the dialog does not work at all. */
  broken = "";
  /** The role that uses the port. @type {Role | null} */
  running = null;
  /** Whether its end was reported; the port may still be closing. */
  ended = false;
  /** Whether STOP was pressed since the start. */
  stopPressed = false;
  /** @type {Sent} */
  sent = { json: "", title: "", baud: 0, raw: false, port: null };
  /** Delays of the replies, in ms. @type {{own: number[], model: number[]}} */
  delays = { own: [], model: [] };
  #hadFacts = false;
  #warned = false;

  /** @param {Device} device */
  constructor(device) {
    this.device = device;
  }

  /** Whether a device may be moving and can be stopped. */
  get mayMove() {
    const { port, unsettled } = this.device;
    return this.running === "stream" || (this.running === null && unsettled !== null && port !== null);
  }

  /** Whether the experiment uses raw packets, which have no replies. */
  get isRaw() {
    return this.facts?.stream.state?.lead !== undefined;
  }

  /** Stores the available roles. Returns the role to select if the first one is not available. @param {Facts} facts @returns {Role | null} */
  setFacts(facts) {
    const other = !this.#hadFacts && facts.stream.why && !facts.serve.why ? "serve" : null;
    this.facts = facts;
    this.#hadFacts = true;
    return other;
  }

  /** Why Start has to be pressed again; empty if it does not. */
  warning() {
    if (!this.device.unsettled || this.#warned) return "";
    this.#warned = true;
    return "The last transfer may not have ended: press STOP first, or start again.";
  }

  /** @param {Role} role @param {boolean} isStop  Whether only STOP is sent. @param {string} title */
  begin(role, isStop, title) {
    const { port, unsettled } = this.device;
    const own = {
      json: this.json,
      title,
      baud: this.facts?.[role].baud ?? 0,
      raw: role === "stream" && this.isRaw,
    };
    this.sent = { ...((isStop && unsettled) || own), port };
    this.running = role;
    this.ended = this.stopPressed = this.#warned = false;
    this.delays = { own: [], model: [] };
  }

  /** A press is never dropped: STOP is sent until a device confirms it. @returns {StopPress} */
  pressStop() {
    const none = /** @type {const} */ ({ action: "none", text: "" });
    if (this.running === "serve" || this.device.port === null) return none;
    if (this.running === null) return { action: "begin", text: "" };
    if (this.sent.raw) {
      if (this.ended) return none;
      return { action: "end", text: "Sending has stopped. The device executes its queue…" };
    }
    this.stopPressed = true;
    const text = this.ended
      ? "STOP will be sent as soon as the port is free…"
      : "Sending STOP until the device confirms it…";
    return { action: "stop", text };
  }

  /** @param {Exchange[]} exchanges */
  exchanged(exchanges) {
    for (const { delay_ms, model_ms, reply } of exchanges) {
      if (delay_ms !== null) this.delays.own.push(delay_ms);
      if (model_ms !== null) this.delays.model.push(model_ms);
      // A device gets ticks only after its first reply.
      if (reply !== null) this.device.unsettled = this.sent;
    }
  }

  /** The end of a stream. @param {Reported} reported */
  reported(reported) {
    const result = outcome(reported);
    // A STOP that came too late for this stream is sent after the port has closed.
    if (!this.ended) this.stopPressed &&= !result.good && !reported.stopped;
    this.ended = true;
    if (result.good) this.device.unsettled = null;
    return result;
  }

  /** The port is closed, or the browser does not release it. Returns whether the worker had failed. */
  closed() {
    const hasFailed = this.facts === null;
    this.running = null;
    this.ended = true;
    return hasFailed;
  }

  /** The worker has failed. Returns the message about the stream; empty if there was none. @param {string} why */
  failed(why) {
    this.facts = null;
    this.json = "";
    if (this.running === null) {
      this.broken = `A part of this page failed: ${why}. Close this dialog and open it again.`;
      return "";
    }
    this.ended = true;
    const isStream = this.running === "stream";
    // Its last replies may not have been reported.
    if (isStream && !this.sent.raw) this.device.unsettled ??= this.sent;
    return `The transfer failed: ${why}.${isStream ? ` ${RUNS_DRY}` : ""}`;
  }
}
