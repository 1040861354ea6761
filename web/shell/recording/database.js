/** The database of saved recordings. Every function can fail: browsers may reject, lose or damage data. */
import { lastCycle, makeRoom } from "./record_limits.js";

/** @typedef {import("./record_limits.js").Saved} Saved */

const DATABASE = "stepscope";
/** Stores of the recordings, and of the pieces of their records with the key [id, number of the piece]. */
const [RECORDINGS, PIECES] = ["recordings", "pieces"];

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
    request.result.createObjectStore(RECORDINGS, { keyPath: "id" });
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

/** Saves a recording and removes the oldest ones if needed. Returns the ids of all saved recordings. @param {Saved} recording @param {Uint8Array[]} pieces */
export function store(recording, pieces) {
  return withDatabase(async (database) => {
    const transaction = database.transaction([RECORDINGS, PIECES], "readwrite");
    const done = completed(transaction);
    // The requests below report the same failure.
    done.catch(() => {});
    const [recordings, pieceStore] = [RECORDINGS, PIECES].map((name) => transaction.objectStore(name));
    const { staying, leaving } = makeRoom(await result(recordings.getAll()), recording);
    for (const id of leaving) {
      recordings.delete(id);
      pieceStore.delete(piecesOf(id));
    }
    recordings.put(recording);
    // One at a time: copying all at once would block the page.
    for (const [number, piece] of pieces.entries()) await result(pieceStore.put(piece, [recording.id, number]));
    await done;
    return [...staying, recording.id];
  });
}

/** @param {IDBDatabase} database @returns {Promise<Saved[]>} */
export const list = (database) => result(database.transaction(RECORDINGS).objectStore(RECORDINGS).getAll());

/** @param {IDBDatabase} database @param {string} id */
export function remove(database, id) {
  const transaction = database.transaction([RECORDINGS, PIECES], "readwrite");
  transaction.objectStore(RECORDINGS).delete(id);
  transaction.objectStore(PIECES).delete(piecesOf(id));
  return completed(transaction);
}

/** The records of a recording; null if they are damaged. @param {IDBDatabase} database @param {string} id @param {number[]} sizes */
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
