/** The state of the controls of the device dialog. */
import { about, ROLES, stopTitle, whyNone } from "./roles.js";

/** @typedef {import("./roles.js").Role} Role */
/** @typedef {import("./session.js").LiveSession} LiveSession */

/**
 * @param {LiveSession} session
 * @param {{role: Role, scenario: import("../../state/types.js").Scenario, noPort: string, isInFront: boolean}} dialog
 *   The selected role; `noPort` says why this page gets no port.
 */
export function controlsOf(session, { role, scenario, noPort, isInFront }) {
  const { device, facts, broken, running, mayMove } = session;
  const { port, unsettled } = device;
  const found = facts?.[role];
  const why = noPort || broken || whyNone(scenario, found);
  const isIdle = running === null;
  const isChooseDisabled = (why !== "" && unsettled === null) || !isIdle;
  const isButtonHidden = !isIdle || !isInFront;
  // Packets without replies cannot be stopped, only not sent any more.
  const isRaw = isIdle ? unsettled === null && session.isRaw : session.sent.raw;
  return {
    about: {
      text: why || about(role, /** @type {import("../../engine/live.js").Role} */ (found)),
      isError: why !== "" && (facts !== null || broken !== ""),
    },
    areRolesDisabled: !isIdle,
    choose: {
      text: port ? "Choose another port…" : "Choose a port…",
      disabled: isChooseDisabled,
      title: isChooseDisabled ? why : "",
      hidden: isButtonHidden,
    },
    isAllowedHidden: isChooseDisabled || isButtonHidden,
    start: {
      text: ROLES[role].start,
      disabled: why !== "" || !isIdle || port === null,
      title: why || (port ? "" : "Choose a port first"),
      hidden: isButtonHidden,
    },
    isEndHidden: running !== "serve",
    aside: { text: isInFront ? "Move aside" : "Bring to front", hidden: isInFront && isIdle },
    stop: {
      hidden: running === "serve" || (role === "serve" && unsettled === null),
      disabled: isIdle && !mayMove && (why !== "" || port === null || isRaw),
      title: stopTitle(isRaw, running === "stream" || (mayMove && isInFront)),
    },
    close: { disabled: !isIdle, title: isIdle ? "" : "Press STOP or end first" },
  };
}

/** What is reported when a role begins. @param {Role} role @param {boolean} isStop */
export const beginText = (role, isStop) => (isStop ? "Sending STOP…" : role === "serve" ? "Replying…" : "Sending…");

/** What the dialog says first while it is not known whether a device has ended. @param {import("./session.js").Device} device */
export function unsettledText({ port, unsettled }) {
  if (!unsettled) return "";
  const where = port ? "" : "choose its port, then press STOP. ";
  return `The last transfer may not have ended: ${where}STOP is sent at ${unsettled.baud} baud.`;
}
