/** Limits of saved recordings, and a check of their records. */

/** @typedef {{id: string, file: string, scenario: string, sizes: number[], replies?: Uint8Array}} Saved  `sizes` are the bytes of its pieces of records. */

/** Maximum bytes of all saved recordings; the oldest are removed first. */
export const MAX_BYTES = 160_000_000;
/** Maximum number of recordings, as many as the engine stores for undo. */
const MAX_RECORDINGS = 3;
/** A record: cycle and levels, of eight bytes each. */
export const RECORD_BYTES = 16;
/** Words of a record, of four bytes each. */
const WORDS = RECORD_BYTES / 4;
/** Highest value of the upper word of the levels: there are 36 signals. */
const MAX_UPPER_LEVELS = 0xf;

/** @param {Saved} recording */
export const sizeOf = ({ sizes, replies }) => sizes.reduce((sum, size) => sum + size, replies?.byteLength ?? 0);

/**
 * The saved recordings that stay when another one is added, oldest first, and those that are removed.
 * @param {Saved[]} saved @param {Saved} added
 */
export function makeRoom(saved, added) {
  let left = MAX_BYTES - sizeOf(added);
  let count = MAX_RECORDINGS - 1;
  /** @type {string[]} */
  const staying = [];
  /** @type {string[]} */
  const leaving = [];
  // An id begins with the time at which it was saved.
  for (const each of saved.toSorted((one, other) => (one.id < other.id ? 1 : -1))) {
    left -= Array.isArray(each.sizes) ? sizeOf(each) : MAX_BYTES;
    if (count-- > 0 && left >= 0) staying.unshift(each.id);
    else leaving.push(each.id);
  }
  return { staying, leaving };
}

/**
 * The cycle of the last record of a piece; null if the piece has no records with increasing cycles.
 * @param {unknown} piece @param {number} size  Its saved size in bytes. @param {number} before  The last cycle of the previous piece.
 */
export function lastCycle(piece, size, before) {
  if (!(piece instanceof Uint8Array) || piece.length !== size || size % RECORD_BYTES !== 0) return null;
  const words = new Uint32Array(piece.buffer, piece.byteOffset, size / 4);
  let last = before;
  for (let at = 0; at < words.length; at += WORDS) {
    const cycle = words[at] + words[at + 1] * 2 ** 32;
    if (cycle <= last || words[at + 3] > MAX_UPPER_LEVELS) return null;
    last = cycle;
  }
  return last;
}
