/** The database of saved recordings. Browsers may refuse, lose or damage what they were given: all of this can fail. */
import { lastCycle, makeRoom } from "./record_limits.js";

/** @typedef {import("./record_limits.js").Saved} Saved */

const DATABASE = "stepscope";
/** What each recording is, and its records: key [id, number of the piece]. */
const [FACTS, PIECES] = ["recordings", "pieces"];

/** @template T @param {IDBRequest<T>} request @returns {Promise<T>} */
const result = (request) =>
  new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });

/** @param {IDBTransaction} transaction @returns {Promise<void>} */
const completed = (transaction) =>
  new Promise((resolve, reject) => {
    transaction.oncomplete = () => resolve();
    transaction.onabort = () => reject(transaction.error);
  });

/** @template T @param {(database: IDBDatabase) => Promise<T>} work @returns {Promise<T>} */
export async function withDatabase(work) {
  const request = indexedDB.open(DATABASE, 1);
  request.onupgradeneeded = () => {
    request.result.createObjectStore(FACTS, { keyPath: "id" });
    request.result.createObjectStore(PIECES);
  };
  const database = await result(request);
  try {
    return await work(database);
  } finally {
    database.close();
  }
}

/** Keys of all pieces of a recording. @param {string} id */
const piecesOf = (id) => IDBKeyRange.bound([id], [id, []]);

/** Saves a recording in place of the oldest ones. Returns the ids of all that are saved. @param {Saved} recording @param {Uint8Array[]} pieces */
export function store(recording, pieces) {
  return withDatabase(async (database) => {
    const transaction = database.transaction([FACTS, PIECES], "readwrite");
    const done = completed(transaction);
    // The requests below report the same failure.
    done.catch(() => {});
    const [facts, stores] = [FACTS, PIECES].map((name) => transaction.objectStore(name));
    const { staying, leaving } = makeRoom(await result(facts.getAll()), recording);
    for (const id of leaving) {
      facts.delete(id);
      stores.delete(piecesOf(id));
    }
    facts.put(recording);
    // One at a time: copies of all would stop the page.
    for (const [number, piece] of pieces.entries()) await result(stores.put(piece, [recording.id, number]));
    await done;
    return [...staying, recording.id];
  });
}

/** @param {IDBDatabase} database @returns {Promise<Saved[]>} */
export const list = (database) => result(database.transaction(FACTS).objectStore(FACTS).getAll());

/** @param {IDBDatabase} database @param {string} id */
export function remove(database, id) {
  const transaction = database.transaction([FACTS, PIECES], "readwrite");
  transaction.objectStore(FACTS).delete(id);
  transaction.objectStore(PIECES).delete(piecesOf(id));
  return completed(transaction);
}

/** Its records; null where they are damaged. @param {IDBDatabase} database @param {string} id @param {number[]} sizes */
export async function load(database, id, sizes) {
  const pieces = [];
  let last = -1;
  for (const [number, size] of sizes.entries()) {
    const piece = await result(database.transaction(PIECES).objectStore(PIECES).get([id, number]));
    const next = lastCycle(piece, size, last);
    if (next === null) return null;
    last = next;
    pieces.push(/** @type {Uint8Array} */ (piece));
  }
  return pieces;
}
