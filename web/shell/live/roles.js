/** What the page can be to a device or to a host (LIVE H4), in words, and why it cannot. */
import { movesStreams, serial } from "../../engine/live.js";
import { counted } from "../../state/number.js";

/** @typedef {import("../../engine/live.js").Role} Found */
/** @typedef {"stream" | "serve"} Role */

/** A page on a busy desktop is sometimes so late, in ms. */
const LATE_MS = 50;

/** @type {{[role in Role]: {label: string, about: string, raw?: string, start: string}}} */
export const ROLES = {
  stream: {
    label: "Stream to a device",
    about: "Sends the ticks of this experiment, each frame confirmed, and verifies the end. The motors move.",
    raw: "Sends the packets of this experiment, each at its time. Nobody answers them: nothing is verified, and STOP only ends the sending. The motors move.",
    start: "Start: the motors move",
  },
  serve: {
    label: "Be a soft device",
    about:
      "Answers a host on the port as the controllers of this experiment would, in real time. At the end the session opens as a scenario.",
    start: "Start answering",
  },
};
/** @type {Role[]} */
export const NAMES = ["stream", "serve"];

const OTHERS =
  "take Chrome or Edge 89 or newer, or Firefox 151 or newer, on a desktop; or the command, stepscope send.";

/** Why this page gets no port; empty where it may. */
export function whyNoPort() {
  if (!globalThis.isSecureContext)
    return "The browser gives ports to secure pages alone: open this page by https, or from http://localhost.";
  if (!serial()) return `This browser has no Web Serial: ${OTHERS}`;
  if (!movesStreams())
    return `This browser cannot hand a port's streams to a worker, where this page uses them: ${OTHERS}`;
  return "";
}

/** What a port tells of itself; empty where it is none of USB. @param {any} port */
export function usbOf(port) {
  const { usbVendorId, usbProductId } = port.getInfo?.() ?? {};
  const hex = (/** @type {number} */ id) => id.toString(16).padStart(4, "0");
  return usbVendorId === undefined ? "" : ` (USB ${hex(usbVendorId)}:${hex(usbProductId ?? 0)})`;
}

/** What a role comes to. @param {Role} name @param {Found} found */
export function about(name, { baud, margin_ms, state }) {
  if (name === "serve") return `${ROLES.serve.about} ${baud} baud.`;
  const { lead, lead_ms, ticks } = state;
  if (lead)
    return `${ROLES.stream.raw} ${counted(ticks, "packet")}, ${counted(lead, "packet")} (${lead_ms.toFixed(0)} ms) ahead, ${baud} baud.`;
  const tight =
    margin_ms < LATE_MS
      ? ` The queue gives the page ${margin_ms.toFixed(0)} ms: a busy desktop is later at times, and then it runs dry (UNDERRUN); longer ticks give more.`
      : "";
  return `${ROLES.stream.about} ${counted(ticks, "tick")}, ${baud} baud.${tight}`;
}

/** Why there is nothing to do with an experiment, as it was found; empty where there is. @param {import("../../state/types.js").Scenario} scenario @param {Found | undefined} found */
export function whyNone({ source }, found) {
  if (source?.standalone)
    return "Not with this experiment: a stand-alone controller has no line; its buttons are in the view Panel, or served by the command, stepscope serve.";
  if (!found) return "Loading…";
  return found.why ? `Not with this experiment: ${found.why}.` : "";
}

/** @param {boolean} raw @param {boolean} byKey  Whether Escape does it, too. */
export function stopTitle(raw, byKey) {
  const key = byKey ? " (Esc)" : "";
  return raw
    ? `Sends no more: the device does what is in its queue${key}; a raw line has no STOP`
    : `STOP: no further ticks, the device stops at once${key}`;
}
