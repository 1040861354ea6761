/** Texts of the two roles of the page: host of a device, or device of a host (LIVE H4). */
import { canTransferStreams, serial } from "../../engine/live.js";
import { counted } from "../../state/number.js";

/** @typedef {import("../../engine/live.js").Role} Found */
/** @typedef {"stream" | "serve"} Role */

/** Typical delay of a page on a busy desktop, in ms. */
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
    label: "Act as a device",
    about:
      "Simulates the controllers of this experiment in real time for a host on the port. At the end the session opens as a scenario.",
    start: "Start replying",
  },
};
/** @type {Role[]} */
export const NAMES = ["stream", "serve"];

const ALTERNATIVES =
  "use Chrome or Edge 89 or later, or Firefox 151 or later, on a desktop; or use the command stepscope send.";

/** Why this page cannot use a port; empty if it can. */
export function whyNoPort() {
  if (!globalThis.isSecureContext)
    return "The browser allows ports only on secure pages: open this page with https, or from http://localhost.";
  if (!serial()) return `This browser does not support Web Serial: ${ALTERNATIVES}`;
  if (!canTransferStreams()) return `This browser cannot transfer the streams of a port to a worker: ${ALTERNATIVES}`;
  return "";
}

/** The USB ids of a port; empty if it has none. @param {any} port */
export function usbOf(port) {
  const { usbVendorId, usbProductId } = port.getInfo?.() ?? {};
  const hex = (/** @type {number} */ id) => id.toString(16).padStart(4, "0");
  return usbVendorId === undefined ? "" : ` (USB ${hex(usbVendorId)}:${hex(usbProductId ?? 0)})`;
}

/** The description of a role for the current experiment. @param {Role} name @param {Found} found */
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

/** Why a role is not available; empty if it is. @param {import("../../state/types.js").Scenario} scenario @param {Found | undefined} found */
export function whyUnavailable({ source }, found) {
  if (source?.standalone)
    return "Not available: a stand-alone controller has no line. Use its buttons in the view Panel, or the command stepscope serve.";
  if (!found) return "Loading…";
  return found.why ? `Not available: ${found.why}.` : "";
}

/** @param {boolean} raw @param {boolean} hasKey  Whether Escape has the same effect. */
export function stopTitle(raw, hasKey) {
  const key = hasKey ? " (Esc)" : "";
  return raw
    ? `Stop sending; the device still executes its queue${key}. A raw line has no STOP`
    : `STOP: the device stops at once${key}`;
}
