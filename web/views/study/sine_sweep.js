/** The sweep of d1: requests, rows and best rows. */
import { short } from "../../state/number.js";

/** @typedef {"position" | "speed" | "acceleration" | "filtered"} Quantity */
/** @typedef {{d1: Float64Array, segments: Float64Array, position: Float64Array, speed: Float64Array, acceleration: Float64Array, filtered: Float64Array, euclidean: Float64Array}} Rows */
/** @typedef {{[name in keyof Rows]: number}} Row */
/** @typedef {{low: number, high: number, points: number, order: number, sensor: number | undefined}} Settings  `sensor` is the bandwidth of an acceleration sensor in harmonics. */

/** A distortion has harmonics 2 and 3 at least. */
export const MIN_ORDER = 3;
/** Maximum order of a scenario. */
export const MAX_ORDER = 1000;
/** Points in one request of the sweep: it takes a few ms. */
const PIECE = 10;
/** Parts of the range, each searched for the best d1 of every number of segments. */
const PARTS = 16;
const NAMES = /** @type {(keyof Rows)[]} */ ([
  "d1",
  "segments",
  "position",
  "speed",
  "acceleration",
  "filtered",
  "euclidean",
]);

/** A d1 with few digits, not below the point where its polyline begins. @param {number} d1 */
export const rounded = (d1) => Math.ceil(d1 * 1e8 - 1e-4) / 1e8;
/** @param {number} ratio */
export const percent = (ratio) => (Number.isFinite(ratio) ? `${short(100 * ratio, 4)} %` : "–");

/** The arguments of each request: all rows, and the best rows of each part of the range. @param {Settings} settings */
export function pieces({ low, high, points, order, sensor }) {
  const rows = Array.from({ length: Math.ceil(points / PIECE) }, (_, index) => [
    low,
    high,
    points,
    order,
    sensor,
    PIECE * index,
    PIECE * (index + 1),
  ]);
  // Polylines are denser at a small d1, so the parts grow geometrically.
  const edge = (/** @type {number} */ index) => (index === PARTS ? high : low * (high / low) ** (index / PARTS));
  const best = Array.from({ length: PARTS }, (_, index) => [edge(index), edge(index + 1), order, sensor]);
  return { rows, best };
}

/** Progress after `done` pieces. @param {number} done @param {number} points */
export function progressOf(done, points) {
  const rows = Math.ceil(points / PIECE);
  return {
    part: done / (rows + PARTS),
    text: done < rows ? `${Math.min(points, done * PIECE)} of ${points} points` : "best d1 of the range",
  };
}

/** @param {Rows | null | undefined} rows @param {number | null} index @returns {Row | null} */
export function rowOf(rows, index) {
  return rows && index !== null && index < rows.d1.length
    ? /** @type {any} */ (Object.fromEntries(NAMES.map((name) => [name, rows[name][index]])))
    : null;
}

/** @param {Rows[]} pieces @returns {Rows} */
export function joined(pieces) {
  return /** @type {any} */ (
    Object.fromEntries(NAMES.map((name) => [name, Float64Array.from(pieces.flatMap((piece) => [...piece[name]]))]))
  );
}

/** The row with the lowest THD of position for each number of segments, in the order of these. @param {Rows} found @returns {Row[]} */
export function bestRows(found) {
  /** @type {Map<number, Row>} */
  const best = new Map();
  for (let index = 0; index < found.d1.length; index++) {
    const row = /** @type {Row} */ (rowOf(found, index));
    if (!(row.position >= (best.get(row.segments)?.position ?? Infinity))) best.set(row.segments, row);
  }
  return [...best.values()].sort((one, other) => one.segments - other.segments);
}

/** The row with the lowest THD of position. @param {Row[]} rows @returns {Row | null} */
export const bestRow = (rows) =>
  rows.reduce((best, row) => (row.position < best.position ? row : best), rows[0]) ?? null;

/** Whether a d1 is at an end of the range: there may be better ones outside. @param {number} d1 @param {Float64Array} range */
export function isAtEnd(d1, range) {
  return [range[0], range[range.length - 1]].some((end) => Math.abs(d1 - end) <= 1e-6 * end);
}

/** The row at a share of the plot area's width; `before` if the share is outside. @param {number} share @param {Rows} rows @param {number | null} before */
export function indexAt(share, rows, before) {
  const last = rows.d1.length - 1;
  return share < -0.02 || share > 1.02 ? before : Math.min(last, Math.max(0, Math.round(share * last)));
}

/** The row that is `by` rows away; without a selected row, the first or the last. @param {Rows | null} rows @param {number | null} selected @param {number} by */
export function movedBy(rows, selected, by) {
  const last = (rows?.d1.length ?? 1) - 1;
  return Math.min(last, Math.max(0, (selected ?? (by > 0 ? -1 : 1)) + by));
}

/** Cells of a row of the table; `none` is the text if there is no row. @param {string} name @param {Row | null} row @param {string} none */
export function cellsOf(name, row, none) {
  if (!row) return [name, none, "", "", "", "", "", ""];
  const { d1, segments, position, speed, acceleration, filtered, euclidean } = row;
  const ratios = [position, speed, acceleration, filtered].map(percent);
  return [name, short(d1, 6), String(segments), ...ratios, short(euclidean, 4)];
}

/** The selected row as the value of the slider. @param {Row | null} row @param {Quantity} quantity */
export function valueText(row, quantity) {
  if (!row) return "no d1 selected";
  return `d1 ${short(row.d1)}, ${row.segments} segments, THD of ${quantity} ${percent(row[quantity])}, Ev ${short(row.euclidean)}; Enter uses it`;
}

/** @param {Quantity} quantity @param {number | undefined} sensor @param {number} order */
export function captionOf(quantity, sensor, order) {
  const what =
    quantity !== "filtered"
      ? quantity
      : sensor === undefined
        ? "acceleration, filtered"
        : `acceleration filtered by a sensor of ${short(sensor, 4)} harmonics`;
  return `THD of ${what} over d1, harmonics 2 to ${order}, %`;
}

/** Why there is no chart of a quantity; empty if there is one. @param {Rows | null} rows @param {Quantity} quantity @param {number | undefined} sensor */
export function whyNoChart(rows, quantity, sensor) {
  if (rows === null || rows[quantity].some(Number.isFinite)) return "";
  return sensor === undefined
    ? "For filtered acceleration, enter a sensor bandwidth under Spectrum in the form, and use a sine in segments."
    : "The sweep with the sensor has not run yet.";
}
