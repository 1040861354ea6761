/** Files that parts of the page offer to save. */

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Span} Span */
/**
 * A file that can be saved. `make` returns its parts. It reports its progress (0 to 1), and `report` throws if the user cancels.
 * @typedef {{name: string, type: string, label: string, make: (report: (progress: number) => void) => Promise<BlobPart[]>}} Offer
 * @typedef {{title: string, offers: Offer[]}} Group
 */

/** The cycles between the cursors, if both are set. @param {State} state @returns {Span | null} */
export function between({ cursors: { a, b } }) {
  return a === null || b === null || a === b ? null : { start: Math.min(a, b), end: Math.max(a, b) };
}

/** A name for files of an experiment. @param {State} state */
export function baseName({ scenario }) {
  const name = (scenario.title ?? "")
    .normalize("NFKD")
    .replace(/\p{M}/gu, "")
    .replace(/[^\w]+/g, "-")
    .replace(/^-+/, "")
    .slice(0, 40)
    .replace(/-+$/, "")
    .toLowerCase();
  return name || "stepscope";
}
