/** Packet files for the export panel. */
import { isFiltering } from "../../state/queries.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{name: string, type: string, label: string, make: (report: (progress: number) => void) => Promise<BlobPart[]>}} PacketFile */

/** Rows per request. */
const ROWS = 20_000;
const FORMATS = [
  { ending: "csv", format: "csv", type: "text/csv", about: "table (CSV)" },
  { ending: "txt", format: "hex", type: "text/plain", about: "bytes as hex, one packet per line" },
  { ending: "bin", format: "bin", type: "application/octet-stream", about: "bytes (binary)" },
];

/**
 * Files of the packets of the visible run: all rows, the filtered rows, and the rows between the cursors; each as CSV, hex and
 * binary.
 * @param {State} state
 * @param {import("../../engine/engine.js").Engine} engine
 * @returns {PacketFile[]}  Empty without a result.
 */
export function packetFiles(state, engine) {
  if (!state.result) return [];
  const { a, b } = state.cursors;
  const scopes = [{ name: "packets", label: "Packets, all", shown: false, between: /** @type {number[]} */ ([]) }];
  if (isFiltering(state.filter))
    scopes.push({ name: "packets-shown", label: "Packets, visible rows", shown: true, between: [] });
  if (a !== null && b !== null) {
    scopes.push({
      name: "packets-a-b",
      label: "Packets between the cursors",
      shown: false,
      between: [Math.min(a, b), Math.max(a, b)],
    });
  }
  return scopes.flatMap((scope) =>
    FORMATS.map(({ ending, format, type, about }) => ({
      name: `stepscope-${scope.name}.${ending}`,
      type,
      label: `${scope.label}: ${about}`,
      make: async (/** @type {(progress: number) => void} */ report) => {
        const parts = [];
        for (let from = 0; from !== undefined; ) {
          const { part, next, rows } = await engine.request(
            "packet_file",
            format,
            scope.shown,
            from,
            ROWS,
            ...scope.between,
          );
          parts.push(part);
          report(Math.min(1, (parts.length * ROWS) / Math.max(1, rows)));
          from = next;
        }
        return parts;
      },
    })),
  );
}
