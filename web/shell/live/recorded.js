/** Opens a recorded session of a soft device as a scenario (LIVE H5). */
import { button, byId } from "../../dom.js";
import { readJson } from "../../state/json.js";
import { counted } from "../../state/number.js";
import { baseName } from "../offers.js";
import { save } from "../save.js";
import { undoHint } from "../storage.js";

/** @typedef {import("../../state/types.js").Page} Page */

/** How long a recorded session may run before it is said that it has not, in ms, and how often that is looked at. */
const PATIENCE_MS = 60_000;
const LOOK_MS = 100;

/** @param {Page} page @param {import("../../engine/live.js").Recorded} session @param {string} gone  That its port is lost, if it is. */
export async function openRecorded({ dispatch, now }, { scenario, digests, whole, set_backs, times }, gone) {
  dispatch({ type: "replace", scenario: readJson(scenario), origin: "shared" });
  const part = whole ? "" : " It has the maximum length of a recording.";
  const paced = set_backs > 0 ? ` It was not in real time: its clock was set back ${counted(set_backs, "time")}.` : "";
  const found = await digestOf(now, now().revision);
  const same = found === digests[now().result?.controller ?? 0];
  const verdict = same
    ? `Recorded. The simulation reproduces the digest ${found} of the session.`
    : found
      ? `The session had the digest ${digests[0]}, but the scenario has ${found}.`
      : `Recorded with the digest ${digests[0]}.`;
  const text = `${verdict}${part}${paced}${gone}${undoHint()}`;
  dispatch({ type: "notice", notice: { kind: same ? "info" : "error", text, place: null } });
  // The notice's line stands by now, and has the button until another one comes.
  const again = button("Save wall-clock times", "Save wall-clock times", () => saveTimes(now(), times));
  byId("link-message").querySelector(".close")?.before(again);
}

/** Beside the scenario, which the export has. @param {import("../../state/types.js").State} state @param {Blob} times */
export function saveTimes(state, times) {
  save(`${baseName(state)}.session.json`, times.type, [times]);
}

/** Of a revision, once it has run; empty where it has not. @param {Page["now"]} now @param {number} revision */
async function digestOf(now, revision) {
  for (let waited = 0; waited < PATIENCE_MS && now().revision === revision; waited += LOOK_MS) {
    const { result } = now();
    if (result?.revision === revision) return result.summary.controllers[result.controller]?.digest ?? "";
    await new Promise((rested) => setTimeout(rested, LOOK_MS));
  }
  return "";
}
