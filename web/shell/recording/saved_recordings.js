/** Saves the last imported recordings with their scenarios, so that a reload shows them again. */
import { errorMessage } from "../../state/error_message.js";
import { readJson } from "../../state/json.js";
import { count } from "../../state/number.js";
import { awaitAnyResult } from "../await_result.js";
import { listedRecordings, listRecordings } from "../storage.js";
import { list, load, remove, store, withDatabase } from "./database.js";
import { MAX_BYTES, RECORD_BYTES, sizeOf } from "./record_limits.js";

/**
 * @typedef {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} Page
 * @typedef {import("./record_limits.js").Saved} Saved
 * @typedef {{id: string, file: string, scenario: string, lost: string}} Known  A recording of this tab. `lost`: why it is not saved; empty if it is.
 * @typedef {{file: string, id: string, lost: string, isOwn: boolean}} Shown  The recording that was visible when the page was left.
 */

/** Maximum time to wait for the first result, in ms. */
const MAX_WAIT_MS = 30_000;
/** The recording that the page showed when it was left; each tab has its own. */
const SHOWN = "stepscope.recording";

/** Recordings of this tab, the newest last. @type {Known[]} */
const known = [];

/** The part of a scenario that identifies its recording, as in the worker (worker.js). @param {any} scenario */
export const scenarioKey = ({ source, clock_hz, bus, run_cycles, plant }) =>
  JSON.stringify([source, clock_hz, bus?.channels, run_cycles, plant]);

/** @returns {string[]} */
function listed() {
  try {
    const list = JSON.parse(listedRecordings() ?? "[]");
    return Array.isArray(list) ? list.map(String) : [];
  } catch {
    return [];
  }
}

/**
 * Saves a recording, and removes the oldest ones if needed.
 * @param {Page} page @param {string} file  Its name. @param {string} scenario @param {Uint8Array[]} pieces  Its records.
 * @param {Uint8Array} [replies]  Bytes of TX, if that was recorded.
 * @returns {Promise<string>}  Why it is not saved; empty if it is.
 */
export async function saveRecording(page, file, scenario, pieces, replies) {
  const id = `${Date.now()}.${Math.random()}`;
  const recording = { id, file, scenario, sizes: pieces.map((piece) => piece.byteLength), replies };
  const lost = sizeOf(recording) > MAX_BYTES ? tooLarge(recording) : await stored(recording, pieces);
  // With the list, a reload reports that the recording is no longer available.
  if (lost) listRecordings(JSON.stringify(listed()));
  known.push({ id, file, scenario, lost });
  watch(page);
  return lost && ` It is available until you leave this page: ${lost}.`;
}

/** @param {Saved} recording */
const tooLarge = (recording) =>
  `${count(sizeOf(recording) / RECORD_BYTES)} changes are more than the ${count(MAX_BYTES / RECORD_BYTES)} that can be saved on this device`;

/** Stores it; returns why it is not stored, or "". @param {Saved} recording @param {Uint8Array[]} pieces */
async function stored(recording, pieces) {
  try {
    if (!listRecordings(JSON.stringify(await store(recording, pieces))))
      throw new Error("the list of recordings cannot be saved");
    return "";
  } catch (error) {
    return `the browser cannot save it (${errorMessage(error)})`;
  }
}

/**
 * Sends the engine the saved recordings of this experiment, of the undo history and of the link in the address. Shows the
 * recording that was visible, if it has no link. Must be called before the first run.
 * @param {Page} page
 */
export async function restore(page) {
  const [before, shown] = [listed(), shownBefore()];
  watch(page);
  if (before.length === 0 && !shown) return;
  let lost = shown?.lost ?? "";
  try {
    lost ||= await withDatabase((database) => restoreFrom(page, database, before, shown));
    if (!lost && shown && !known.some(({ id }) => id === shown.id)) lost = "it was not saved";
  } catch (error) {
    lost ||= `the browser cannot read it (${errorMessage(error)})`;
    listRecordings("[]");
  }
  if (!lost) return;
  const name = shown ? `The recording ${shown.file}` : "An earlier recording";
  const text = `${name} is no longer available: ${lost}. The views show the simulation; open the file again.`;
  // A scenario from the address would remove an earlier notice.
  void awaitAnyResult(page, MAX_WAIT_MS).then(() =>
    page.dispatch({ type: "notice", notice: { kind: "error", text, location: null } }),
  );
}

/**
 * Restores the recordings; returns why one is lost, or "".
 * @param {Page} page @param {IDBDatabase} database @param {string[]} before @param {Shown | null} shown
 */
async function restoreFrom(page, database, before, shown) {
  const { engine, dispatch, now } = page;
  const { scenario, past, future } = now();
  const wanted = new Set([scenario, ...[...past, ...future].map((moment) => moment.scenario)].map(scenarioKey));
  const linked = await engine.request("decode_link", location.hash.slice(1)).catch(() => null);
  const addressed = linked?.scenario ? scenarioKey(readJson(linked.scenario)) : null;
  if (addressed !== null) wanted.add(addressed);
  const all = await list(database);
  const available = new Set(all.map(({ id }) => id));
  let lost = before.some((id) => !available.has(id)) ? "its saved copy is gone" : "";
  for (const { id, file, scenario, sizes, replies } of all) {
    const isShown = shown?.id === id;
    // The core upgrades it if an earlier version saved it.
    const checked = await engine.request("check", String(scenario));
    const read = readJson(checked.scenario);
    if (!isShown && !wanted.has(scenarioKey(read))) continue;
    const pieces = checked.problems.length === 0 && Array.isArray(sizes) ? await load(database, id, sizes) : null;
    if (!pieces) {
      lost ||= `the saved copy of ${file} is damaged`;
      await remove(database, id);
      available.delete(id);
      continue;
    }
    engine.showRecording(checked.scenario, pieces, replies instanceof Uint8Array ? replies : undefined);
    known.push({ id, file, scenario: checked.scenario, lost: "" });
    if (isShown && !shown.isOwn && scenarioKey(read) !== addressed) {
      // The link in the address is of an earlier experiment, so it is removed.
      history.replaceState(null, "", location.pathname + location.search);
      dispatch({ type: "replace", scenario: read, origin: "shared" });
    }
  }
  if (lost) listRecordings(JSON.stringify([...available]));
  return lost;
}

/** The visible recording when the page was left, if this is a reload. @returns {Shown | null} */
function shownBefore() {
  try {
    const [entry] = /** @type {PerformanceNavigationTiming[]} */ (performance.getEntriesByType("navigation"));
    const shown = JSON.parse(sessionStorage.getItem(SHOWN) ?? "null");
    return entry?.type !== "navigate" && typeof shown?.file === "string" ? shown : null;
  } catch {
    return null;
  }
}

let isWatched = false;

/** Saves which recording is visible when the page is left. @param {Page} page */
function watch({ now }) {
  if (isWatched) return;
  isWatched = true;
  window.addEventListener("pagehide", () => {
    const { scenario, origin, result, revision } = now();
    const recorded = result?.revision === revision && result.summary.recorded;
    const found = recorded && known.findLast((each) => scenarioKey(readJson(each.scenario)) === scenarioKey(scenario));
    try {
      if (!found) return sessionStorage.removeItem(SHOWN);
      const { file, id, lost } = found;
      sessionStorage.setItem(SHOWN, JSON.stringify({ file, id, lost, isOwn: origin === "own" }));
    } catch {
      // Private windows and full disks reject this; the recording then has to be opened again.
    }
  });
}
