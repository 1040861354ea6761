/** Packet files for the export panel. */
import { isFiltering } from "../../state/queries.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{name: string, type: string, label: string, make: (pace: (part: number) => void) => Promise<BlobPart[]>}} PacketFile */

/** Rows per request. */
const ROWS = 20_000;
const FORMATS = [
  { ending: "csv", format: "csv", type: "text/csv", about: "table (CSV)" },
  { ending: "txt", format: "hex", type: "text/plain", about: "bytes as hex, one packet per line" },
  { ending: "bin", format: "bin", type: "application/octet-stream", about: "bytes (binary)" },
];

/**
 * The files that the packets of the visible run can be saved as: of all rows, of those that the filter shows, of
 * those on the line between the cursors; each as a table, as hex and as bytes. Nothing is made before `make`.
 * @param {State} state
 * @param {import("../../engine/engine.js").Engine} engine
 * @returns {PacketFile[]}  None without a result.
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
      make: async (/** @type {(part: number) => void} */ pace) => {
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
          pace(Math.min(1, (parts.length * ROWS) / Math.max(1, rows)));
          from = next;
        }
        return parts;
      },
    })),
  );
}
