/**
 * Recordings that this device keeps, so that they are there after a reload: the records of the last few that were opened,
 * with the scenario that each stands for. Their database is looked at only where `recordingsKept` (storage.js) has a list.
 *
 * Storage may refuse, lose or damage what it was given, and tells in its own time: whatever it does is said, and the page
 * goes on with what the model makes of the scenario.
 */
import { readJson } from "../state/json.js";
import { count } from "../state/number.js";
import { listRecordings, recordingsKept } from "./storage.js";

/**
 * @typedef {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} Page
 * @typedef {{id: string, file: string, scenario: string, sizes: number[], replies?: Uint8Array}} Kept  Its pieces have so many bytes.
 * @typedef {{id: string, file: string, scenario: string, lost: string}} Known  A recording that this tab has, and why it is not kept; "" where it is.
 * @typedef {{file: string, id: string, lost: string, isOwn: boolean}} Shown  The one that was on show when the page was left.
 */

const DATABASE = "stepscope";
/** What each recording is, and its records: key [id, place of the piece]. */
const [FACTS, PIECES] = ["recordings", "pieces"];
/** Most bytes of all that is kept together; the oldest recordings go first. */
export const MAX_BYTES = 160_000_000;
/** Most recordings: as many as the engine has for undo. */
const MAX_KEPT = 3;
/** A record: cycle and levels. */
const BYTES = 16;
/** Words of a record, of four bytes each, and what the upper one of its levels may hold: 36 signals. */
const [WORDS, UPPER_LEVELS] = [BYTES / 4, 0xf];
/** How long, and how often, a first result is waited for, in ms. */
const [PATIENCE_MS, REST_MS] = [30_000, 100];
/** What the page that was left showed; a tab's own. */
const SHOWN = "stepscope.recording";

/** Recordings of this tab, the newest last. @type {Known[]} */
const known = [];

/** What a recording stands for, as the worker has it (worker.js). @param {any} scenario */
export const stands = ({ source, clock_hz, bus, run_cycles, plant }) =>
  JSON.stringify([source, clock_hz, bus?.channels, run_cycles, plant]);

/** @template T @param {IDBRequest<T>} request @returns {Promise<T>} */
const answered = (request) =>
  new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });

/** @param {IDBTransaction} transaction @returns {Promise<void>} */
const ended = (transaction) =>
  new Promise((resolve, reject) => {
    transaction.oncomplete = () => resolve();
    transaction.onabort = () => reject(transaction.error);
  });

/** @template T @param {(database: IDBDatabase) => Promise<T>} work @returns {Promise<T>} */
async function withDatabase(work) {
  const request = indexedDB.open(DATABASE, 1);
  request.onupgradeneeded = () => {
    request.result.createObjectStore(FACTS, { keyPath: "id" });
    request.result.createObjectStore(PIECES);
  };
  const database = await answered(request);
  try {
    return await work(database);
  } finally {
    database.close();
  }
}

/** All pieces of a recording. @param {string} id */
const piecesOf = (id) => IDBKeyRange.bound([id], [id, []]);

/** @param {Kept} kept */
const sizeOf = ({ sizes, replies }) => sizes.reduce((sum, size) => sum + size, replies?.byteLength ?? 0);

/** @returns {string[]} */
function listed() {
  try {
    const list = JSON.parse(recordingsKept() ?? "[]");
    return Array.isArray(list) ? list.map(String) : [];
  } catch {
    return [];
  }
}

/**
 * Keeps a recording in the place of the oldest ones, if there is room for it.
 * @param {Page} page @param {string} file  Its name. @param {string} scenario  What it stands for. @param {Uint8Array[]} pieces
 * @param {Uint8Array} [replies]  What was recorded on TX, where that was.
 * @returns {Promise<string>}  What there is to say of it.
 */
export async function keep(page, file, scenario, pieces, replies) {
  const id = `${Date.now()}.${Math.random()}`;
  const kept = { id, file, scenario, sizes: pieces.map((piece) => piece.byteLength), replies };
  const lost = sizeOf(kept) > MAX_BYTES ? tooLarge(kept) : await stored(kept, pieces);
  // After a reload it is told that it is gone.
  if (lost) listRecordings(JSON.stringify(listed()));
  known.push({ id, file, scenario, lost });
  watch(page);
  return lost && ` It is there until this page is left: ${lost}.`;
}

/** @param {Kept} kept */
const tooLarge = (kept) =>
  `${count(sizeOf(kept) / BYTES)} changes are more than the ${count(MAX_BYTES / BYTES)} that are kept on this device`;

/** Stores it; says why it is not stored. @param {Kept} kept @param {Uint8Array[]} pieces */
async function stored(kept, pieces) {
  try {
    const list = await withDatabase(async (database) => {
      const transaction = database.transaction([FACTS, PIECES], "readwrite");
      const done = ended(transaction);
      // Told by what follows, too.
      done.catch(() => {});
      const [facts, stores] = [FACTS, PIECES].map((name) => transaction.objectStore(name));
      /** @type {Kept[]} */
      const earlier = await answered(facts.getAll());
      let left = MAX_BYTES - sizeOf(kept);
      let places = MAX_KEPT - 1;
      const staying = [];
      for (const each of earlier.sort((one, other) => (one.id < other.id ? 1 : -1))) {
        left -= Array.isArray(each.sizes) ? sizeOf(each) : MAX_BYTES;
        if (places-- > 0 && left >= 0) staying.unshift(each.id);
        else {
          facts.delete(each.id);
          stores.delete(piecesOf(each.id));
        }
      }
      facts.put(kept);
      // One at a time: copies of all would hold the page.
      for (const [place, piece] of pieces.entries()) await answered(stores.put(piece, [kept.id, place]));
      await done;
      return [...staying, kept.id];
    });
    if (!listRecordings(JSON.stringify(list))) throw new Error("no list of it can be kept");
    return "";
  } catch (error) {
    return `this browser does not keep it (${message(error)})`;
  }
}

/** @param {unknown} error */
const message = (error) => (error instanceof Error && error.message ? error.message : String(error));

/**
 * Gives the engine what was kept of the experiments that are there again: of this one, of those that undo and redo lead to,
 * and of the address. A recording that was on show and has no link is shown. To be called before the first run.
 * @param {Page} page
 */
export async function restore(page) {
  const [before, shown] = [listed(), shownBefore()];
  watch(page);
  if (before.length === 0 && !shown) return;
  let lost = shown?.lost ?? "";
  try {
    lost ||= await withDatabase((database) => restored(page, database, before, shown));
    if (!lost && shown && !known.some(({ id }) => id === shown.id)) lost = "it was not kept";
  } catch (error) {
    lost ||= `this browser does not give it (${message(error)})`;
    listRecordings("[]");
  }
  if (!lost) return;
  const name = shown ? `The recording ${shown.file}` : "A recording that was opened before";
  const text = `${name} is not there any more: ${lost}. The views show what the model makes of the experiment; open the file again.`;
  void shownFirst(page).then(() => page.dispatch({ type: "notice", notice: { kind: "error", text, place: null } }));
}

/** Until the views show something: what the address brings in takes notices away. @param {Page} page */
async function shownFirst({ now }) {
  for (let waited = 0; waited < PATIENCE_MS && !now().result; waited += REST_MS)
    await new Promise((rested) => setTimeout(rested, REST_MS));
}

/**
 * As `restore`; why something is lost, or "".
 * @param {Page} page @param {IDBDatabase} database @param {string[]} before @param {Shown | null} shown
 */
async function restored(page, database, before, shown) {
  const { engine, dispatch, now } = page;
  const { scenario, past, future } = now();
  const wanted = new Set([scenario, ...[...past, ...future].map((moment) => moment.scenario)].map(stands));
  const linked = await engine.ask("decode_link", location.hash.slice(1)).catch(() => null);
  const addressed = linked?.scenario ? stands(readJson(linked.scenario)) : null;
  if (addressed !== null) wanted.add(addressed);
  /** @type {Kept[]} */
  const all = await answered(database.transaction(FACTS).objectStore(FACTS).getAll());
  const there = new Set(all.map(({ id }) => id));
  let lost = before.some((id) => !there.has(id)) ? "what was kept of it is gone" : "";
  for (const { id, file, scenario, sizes, replies } of all) {
    const isShown = shown?.id === id;
    // Kept by an earlier version, perhaps: the core reads it.
    const own = await engine.ask("check", String(scenario));
    const read = readJson(own.scenario);
    if (!isShown && !wanted.has(stands(read))) continue;
    const pieces = own.problems.length === 0 && Array.isArray(sizes) ? await load(database, id, sizes) : null;
    if (!pieces) {
      lost ||= `what was kept of ${file} is damaged`;
      await removed(database, id);
      there.delete(id);
      continue;
    }
    engine.record(own.scenario, pieces, replies instanceof Uint8Array ? replies : undefined);
    known.push({ id, file, scenario: own.scenario, lost: "" });
    if (isShown && !shown.isOwn && stands(read) !== addressed) {
      // The address is that of what was shown before: there is no link of it, or the page was left before it stood there.
      history.replaceState(null, "", location.pathname + location.search);
      dispatch({ type: "replace", scenario: read, origin: "shared" });
    }
  }
  if (lost) listRecordings(JSON.stringify([...there]));
  return lost;
}

/** @param {IDBDatabase} database @param {string} id */
function removed(database, id) {
  const transaction = database.transaction([FACTS, PIECES], "readwrite");
  transaction.objectStore(FACTS).delete(id);
  transaction.objectStore(PIECES).delete(piecesOf(id));
  return ended(transaction);
}

/** Its records; null where they are not those of a recording. @param {IDBDatabase} database @param {string} id @param {number[]} sizes */
async function load(database, id, sizes) {
  const pieces = [];
  let last = -1;
  for (const [place, size] of sizes.entries()) {
    const piece = await answered(database.transaction(PIECES).objectStore(PIECES).get([id, place]));
    if (!(piece instanceof Uint8Array) || piece.length !== size || size % BYTES !== 0) return null;
    const words = new Uint32Array(piece.buffer, piece.byteOffset, size / 4);
    for (let at = 0; at < words.length; at += WORDS) {
      const cycle = words[at] + words[at + 1] * 2 ** 32;
      if (cycle <= last || words[at + 3] > UPPER_LEVELS) return null;
      last = cycle;
    }
    pieces.push(piece);
  }
  return pieces;
}

/** What the page that was left showed, if this is it again. @returns {Shown | null} */
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

/** Notes what is on show when the page is left. @param {Page} page */
function watch({ now }) {
  if (isWatched) return;
  isWatched = true;
  window.addEventListener("pagehide", () => {
    const { scenario, origin, result, revision } = now();
    const recorded = result?.revision === revision && result.summary.recorded;
    const found = recorded && known.findLast((each) => stands(readJson(each.scenario)) === stands(scenario));
    try {
      if (!found) return sessionStorage.removeItem(SHOWN);
      const { file, id, lost } = found;
      sessionStorage.setItem(SHOWN, JSON.stringify({ file, id, lost, isOwn: origin === "own" }));
    } catch {
      // Private windows and full disks refuse; the recording then has to be opened again.
    }
  });
}
