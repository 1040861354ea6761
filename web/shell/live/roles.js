/** What the page can be to a device or to a host (LIVE H4), as text, and why it cannot. */
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
    about: "Sends the ticks of this experiment in confirmed frames and verifies the result. The motors move.",
    raw: "Sends the packets of this experiment at their times. They get no reply, so nothing is verified, and STOP only ends the sending. The motors move.",
    start: "Start: the motors move",
  },
  serve: {
    label: "Be a soft device",
    about:
      "Replies to a host on the port like the controllers of this experiment, in real time. At the end the session opens as a scenario.",
    start: "Start replying",
  },
};
/** @type {Role[]} */
export const NAMES = ["stream", "serve"];

const OTHERS =
  "use Chrome or Edge 89 or later, or Firefox 151 or later, on a desktop; or use the command stepscope send.";

/** Why this page gets no port; empty where it may. */
export function whyNoPort() {
  if (!globalThis.isSecureContext)
    return "The browser allows ports only on secure pages: open this page with https, or from http://localhost.";
  if (!serial()) return `This browser does not support Web Serial: ${OTHERS}`;
  if (!movesStreams()) return `This browser cannot transfer the streams of a port to a worker: ${OTHERS}`;
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
      ? ` The queue covers only ${margin_ms.toFixed(0)} ms: on a busy desktop it may run empty (UNDERRUN). Use longer ticks.`
      : "";
  return `${ROLES.stream.about} ${counted(ticks, "tick")}, ${baud} baud.${tight}`;
}

/** Why there is nothing to do with an experiment, as it was found; empty where there is. @param {import("../../state/types.js").Scenario} scenario @param {Found | undefined} found */
export function whyNone({ source }, found) {
  if (source?.standalone)
    return "Not available: a stand-alone controller has no line. Use its buttons in the view Panel, or the command stepscope serve.";
  if (!found) return "Loading…";
  return found.why ? `Not available: ${found.why}.` : "";
}

/** @param {boolean} raw @param {boolean} byKey  Whether Escape does it, too. */
export function stopTitle(raw, byKey) {
  const key = byKey ? " (Esc)" : "";
  return raw
    ? `Stop sending; the device still executes its queue${key}. A raw line has no STOP`
    : `STOP: the device stops at once${key}`;
}
