/** Files that parts of the page offer to save. */

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Span} Span */
/**
 * A file that can be saved. `make` gives its parts; `pace` is to be called as it goes on, and throws where the user
 * cancels.
 * @typedef {{name: string, type: string, label: string, make: (pace: (part: number) => void) => Promise<BlobPart[]>}} Offer
 * @typedef {{title: string, offers: Offer[]}} Group
 */

/** What lies between the cursors, if both are set. @param {State} state @returns {Span | null} */
export function between({ cursors: { a, b } }) {
  return a === null || b === null || a === b ? null : { start: Math.min(a, b), end: Math.max(a, b) };
}

/** A name for files of an experiment. @param {State} state */
export function baseName({ scenario }) {
  const name = (scenario.title ?? "")
    .normalize("NFKD")
    .replace(/[^\w]+/g, "-")
    .replace(/^-+|-+$/g, "")
    .toLowerCase()
    .slice(0, 40);
  return name || "stepscope";
}
