/** Rows of the strip, and the script entry under a pointer or key. */
import { INPUTS } from "./names.js";

/** @typedef {import("./script.js").Entry} Entry */
/** @typedef {import("./script.js").Placed} Placed */

/** Height of a row, and of the time's labels, in CSS pixels. */
export const ROW_PX = 22;
export const TIME_PX = 18;
/** Bands over the inputs. */
export const BANDS = /** @type {const} */ (["state", "group", "loop", "trust"]);
/** The row of pushes. */
export const PUSH = "push";
/** Height of the position's curve above the bands, in CSS pixels. */
const [MIN_CURVE_PX, MAX_CURVE_PX] = [58, 190];
/** An entry is within reach of a pointer at this distance, in CSS pixels. */
const REACH_PX = 8;

/** The inputs that have a row: those that changed, and those of the script. @param {Iterable<string>} changed @param {Placed[]} entries */
export function rowsOf(changed, entries) {
  const used = new Set([...changed, ...entries.map(({ entry }) => entry.input ?? PUSH)]);
  return [...INPUTS, PUSH].filter((input) => used.has(input));
}

/** The row of an entry, below the bands. @param {string[]} rows @param {Entry} entry */
export const rowOf = (rows, { input }) => BANDS.length + rows.indexOf(input ?? PUSH);

/** Heights in a room of this many CSS pixels: the curve takes what the rows leave. @param {number} room @param {string[]} rows */
export function heights(room, rows) {
  const below = (BANDS.length + rows.length) * ROW_PX;
  const curve = Math.min(MAX_CURVE_PX, Math.max(MIN_CURVE_PX, Math.floor(room - below - TIME_PX)));
  return { curve, all: curve + below };
}

/** @param {Placed | null} one @param {Placed} other */
const isSame = (one, other) => one !== null && one.owner === other.owner && one.index === other.index;

/** The entry before or after the selected one; from none the last or the first. @param {Placed[]} all @param {Placed | null} selected @param {number} by @returns {Placed | undefined} */
export function entryAfter(all, selected, by) {
  const at = all.findIndex((each) => isSame(selected, each));
  return all[at < 0 ? (by > 0 ? 0 : all.length - 1) : at + by];
}

/** The entry of the next row up or down that is nearest in time. @param {Placed[]} all @param {string[]} rows @param {Placed | null} selected @param {number} by @returns {Placed | undefined} */
export function entryBelow(all, rows, selected, by) {
  const away = (/** @type {Placed} */ { entry }) => Math.abs(entry.cycle - (selected?.entry.cycle ?? 0));
  const from = selected ? rowOf(rows, selected.entry) : BANDS.length - (by > 0 ? 1 : 0);
  for (let at = from + by; at >= BANDS.length && at < BANDS.length + rows.length; at += by) {
    const [first] = all.filter(({ entry }) => rowOf(rows, entry) === at).sort((a, b) => away(a) - away(b));
    if (first) return first;
  }
  return undefined;
}

/** The entry under a pointer. @param {Placed[]} all @param {string[]} rows @param {number} row @param {(cycle: number) => number} distance  In CSS pixels. @returns {Placed | undefined} */
export function entryAt(all, rows, row, distance) {
  return all
    .filter(({ entry }) => rowOf(rows, entry) === row && distance(entry.cycle) <= REACH_PX)
    .sort((a, b) => distance(a.entry.cycle) - distance(b.entry.cycle))[0];
}
