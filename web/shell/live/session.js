/** The state of the device dialog, without DOM and port. */
import { outcome } from "./report.js";

/** @typedef {import("../../engine/live.js").Facts} Facts */
/** @typedef {import("../../engine/live.js").Exchange} Exchange */
/** @typedef {import("../../engine/live.js").Reported} Reported */
/** @typedef {import("./roles.js").Role} Role */
/** @typedef {{json: string, title: string, baud: number, raw: boolean, port: any}} Sent  An experiment as it goes on a port. */
/**
 * What outlives the dialog: the selected port, and what a device has replied to and is not known to have ended. STOP goes as that
 * went, also from the next dialog.
 * @typedef {{port: any, unsettled: Sent | null}} Device
 */
/** @typedef {{action: "none" | "begin" | "end" | "stop", text: string}} Press  What a press of STOP does. */

/** The end of a device that nobody sends to. */
export const RUNS_DRY =
  "The device executes its queue and stops with UNDERRUN. Switch off its power if it must not move.";

export class LiveSession {
  /** What can be done with the experiment; null until that is known. @type {Facts | null} */
  facts = null;
  /** The experiment of `facts`. */
  json = "";
  /** Why nothing can be done at all. */
  broken = "";
  /** What has the port. @type {Role | null} */
  running = null;
  /** Whether its end was reported: the port is being given back. */
  ended = false;
  /** Whether STOP was pressed meanwhile. */
  stopPressed = false;
  /** @type {Sent} */
  sent = { json: "", title: "", baud: 0, raw: false, port: null };
  /** Of the replies, in ms. @type {{own: number[], model: number[]}} */
  delays = { own: [], model: [] };
  #hadFacts = false;
  #warned = false;

  /** @param {Device} device */
  constructor(device) {
    this.device = device;
  }

  /** Whether a device may move by what was sent, and can be told to stop. */
  get mayMove() {
    const { port, unsettled } = this.device;
    return this.running === "stream" || (this.running === null && unsettled !== null && port !== null);
  }

  /** Whether the experiment's packets would be sent without replies. */
  get isRaw() {
    return this.facts?.stream.state?.lead !== undefined;
  }

  /** Returns the role to select where the first one is impossible. @param {Facts} facts @returns {Role | null} */
  setFacts(facts) {
    const other = !this.#hadFacts && facts.stream.why && !facts.serve.why ? "serve" : null;
    this.facts = facts;
    this.#hadFacts = true;
    return other;
  }

  /** Why a start needs one more press; empty where it does not. */
  warning() {
    if (!this.device.unsettled || this.#warned) return "";
    this.#warned = true;
    return "The last transfer may not have ended: press STOP first, or start again.";
  }

  /** @param {Role} role @param {boolean} isStop  Whether STOP is all that is sent. @param {string} title */
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

  /** Only a STOP that reaches a device is confirmed, so a press is never dropped. @returns {Press} */
  pressStop() {
    const none = /** @type {const} */ ({ action: "none", text: "" });
    if (this.running === "serve" || this.device.port === null) return none;
    if (this.running === null) return { action: "begin", text: "" };
    if (this.sent.raw) {
      if (this.ended) return none;
      return { action: "end", text: "Sending has ended; the device executes its queue…" };
    }
    this.stopPressed = true;
    const text = this.ended
      ? "STOP is sent as soon as the port is free…"
      : "STOP is sent until the device confirms it…";
    return { action: "stop", text };
  }

  /** @param {Exchange[]} exchanges */
  exchanged(exchanges) {
    for (const { delay_ms, model_ms, reply } of exchanges) {
      if (delay_ms !== null) this.delays.own.push(delay_ms);
      if (model_ms !== null) this.delays.model.push(model_ms);
      // A device that has not replied gets no tick.
      if (reply !== null) this.device.unsettled = this.sent;
    }
  }

  /** The end of a stream. @param {Reported} reported */
  reported(reported) {
    const result = outcome(reported);
    // A STOP that was pressed too late for this stream goes once the port is given back.
    if (!this.ended) this.stopPressed &&= !result.good && !reported.stopped;
    this.ended = true;
    if (result.good) this.device.unsettled = null;
    return result;
  }

  /** The port is given back, or the browser keeps it. Returns whether the worker had failed. */
  closed() {
    const hasFailed = this.facts === null;
    this.running = null;
    this.ended = true;
    return hasFailed;
  }

  /** The worker that had the port has failed. Returns what to report of the stream; empty where there was none. @param {string} why */
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
    return `This failed: ${why}.${isStream ? ` ${RUNS_DRY}` : ""}`;
  }
}
