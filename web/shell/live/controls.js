/** The state of the controls of the device dialog. */
import { about, ROLES, stopTitle, whyUnavailable } from "./roles.js";

/** @typedef {import("./roles.js").Role} Role */
/** @typedef {import("./session.js").LiveSession} LiveSession */

/**
 * @param {LiveSession} session
 * @param {{role: Role, scenario: import("../../state/types.js").Scenario, noPort: string, isInFront: boolean}} dialog
 *   The selected role; `noPort`: why this page cannot use a port.
 */
export function controlsOf(session, { role, scenario, noPort, isInFront }) {
  const { device, facts, broken, running, mayMove } = session;
  const { port, unsettled } = device;
  const found = facts?.[role];
  const why = noPort || broken || whyUnavailable(scenario, found);
  const isIdle = running === null;
  const isChooseDisabled = (why !== "" && unsettled === null) || !isIdle;
  const isButtonHidden = !isIdle || !isInFront;
  // A raw line has no STOP: only the sending can be stopped.
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

/** The status when a role starts. @param {Role} role @param {boolean} isStop  Whether only STOP is sent. */
export const beginText = (role, isStop) => (isStop ? "Sending STOP…" : role === "serve" ? "Replying…" : "Sending…");

/** The first message of the dialog if the last transfer may not have ended. @param {import("./session.js").Device} device */
export function unsettledText({ port, unsettled }) {
  if (!unsettled) return "";
  const instruction = port ? "" : "choose its port, then press STOP. ";
  return `The last transfer may not have ended: ${instruction}STOP is sent at ${unsettled.baud} baud.`;
}
