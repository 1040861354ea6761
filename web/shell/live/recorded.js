/** Opens the recorded session of the page as a device (LIVE H5). */
import { button, byId } from "../../dom.js";
import { readJson } from "../../state/json.js";
import { counted } from "../../state/number.js";
import { awaitResult } from "../await_result.js";
import { baseName } from "../offers.js";
import { save } from "../save.js";
import { undoHint } from "../storage.js";

/** @typedef {import("../../state/types.js").Page} Page */

/** @param {Page} page @param {import("../../engine/live.js").Recorded} session @param {string} portLost  The message if its port is lost. */
export async function openRecorded({ dispatch, now }, { scenario, digests, whole, set_backs, times }, portLost) {
  dispatch({ type: "replace", scenario: readJson(scenario), origin: "shared" });
  const part = whole ? "" : " It has the maximum length of a recording.";
  const paced = set_backs > 0 ? ` It was not in real time: its clock was set back ${counted(set_backs, "time")}.` : "";
  const result = await awaitResult({ now });
  const found = result?.summary.controllers[result.controller]?.digest ?? "";
  const same = found === digests[now().result?.controller ?? 0];
  const comparison = same
    ? `Recorded. The simulation reproduces the digest ${found} of the session.`
    : found
      ? `The session had the digest ${digests[0]}, but the scenario has ${found}.`
      : `Recorded with the digest ${digests[0]}.`;
  const text = `${comparison}${part}${paced}${portLost}${undoHint()}`;
  dispatch({ type: "notice", notice: { kind: same ? "info" : "error", text, location: null } });
  // The notice is already drawn; it has the button until the next notice.
  const again = button("Save wall-clock times", "Save wall-clock times", () => saveTimes(now(), times));
  byId("link-message").querySelector(".close")?.before(again);
}

/** Saves the wall-clock times next to the scenario. @param {import("../../state/types.js").State} state @param {Blob} times */
export function saveTimes(state, times) {
  save(`${baseName(state)}.session.json`, times.type, [times]);
}
