/** Rows of the strip, and the script entry under a pointer or key. */
import { INPUTS } from "./names.js";

/** @typedef {import("./script.js").Entry} Entry */
/** @typedef {import("./script.js").Placed} Placed */

/** Height of a row, and of the time labels, in CSS pixels. */
export const ROW_PX = 22;
export const TIME_PX = 18;
/** Bands above the inputs. */
export const BANDS = /** @type {const} */ (["state", "group", "loop", "position"]);
/** The row of pushes. */
export const PUSH = "push";
/** Minimum and maximum height of the position curve above the bands, in CSS pixels. */
const [MIN_CURVE_PX, MAX_CURVE_PX] = [58, 190];
/** Maximum distance of the pointer from an entry, in CSS pixels. */
const REACH_PX = 8;

/** The inputs with a row: those that change in the run, and those in the script. @param {Iterable<string>} changed @param {Placed[]} entries */
export function rowsOf(changed, entries) {
  const used = new Set([...changed, ...entries.map(({ entry }) => entry.input ?? PUSH)]);
  return [...INPUTS, PUSH].filter((input) => used.has(input));
}

/** The row of an entry, below the bands. @param {string[]} rows @param {Entry} entry */
export const rowOf = (rows, { input }) => BANDS.length + rows.indexOf(input ?? PUSH);

/** Heights of the curve and of everything in CSS pixels; the curve gets what the rows leave. @param {number} available @param {string[]} rows */
export function heights(available, rows) {
  const below = (BANDS.length + rows.length) * ROW_PX;
  const curve = Math.min(MAX_CURVE_PX, Math.max(MIN_CURVE_PX, Math.floor(available - below - TIME_PX)));
  return { curve, all: curve + below };
}

/** @param {Placed | null} one @param {Placed} other */
const isSame = (one, other) => one !== null && one.owner === other.owner && one.index === other.index;

/** The entry before or after the selected one; without a selection the last or first one. @param {Placed[]} all @param {Placed | null} selected @param {number} by @returns {Placed | undefined} */
export function entryAfter(all, selected, by) {
  const at = all.findIndex((each) => isSame(selected, each));
  return all[at < 0 ? (by > 0 ? 0 : all.length - 1) : at + by];
}

/** The entry of the next row above or below that is nearest in time. @param {Placed[]} all @param {string[]} rows @param {Placed | null} selected @param {number} by @returns {Placed | undefined} */
export function entryBelow(all, rows, selected, by) {
  const distance = (/** @type {Placed} */ { entry }) => Math.abs(entry.cycle - (selected?.entry.cycle ?? 0));
  const from = selected ? rowOf(rows, selected.entry) : BANDS.length - (by > 0 ? 1 : 0);
  for (let at = from + by; at >= BANDS.length && at < BANDS.length + rows.length; at += by) {
    const [nearest] = all.filter(({ entry }) => rowOf(rows, entry) === at).sort((a, b) => distance(a) - distance(b));
    if (nearest) return nearest;
  }
  return undefined;
}

/** The entry under a pointer. @param {Placed[]} all @param {string[]} rows @param {number} row @param {(cycle: number) => number} distance  In CSS pixels. @returns {Placed | undefined} */
export function entryAt(all, rows, row, distance) {
  return all
    .filter(({ entry }) => rowOf(rows, entry) === row && distance(entry.cycle) <= REACH_PX)
    .sort((a, b) => distance(a.entry.cycle) - distance(b.entry.cycle))[0];
}
