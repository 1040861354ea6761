/** The layout of panes on a wide screen: edges, folded and maximized views. */
import { savedRows } from "../state/row_choices.js";
import { PLACED, visibleViewOf } from "../state/views.js";
import { bandsOf, GAP_PX } from "./grid.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Panes} Panes */
/** @typedef {import("../state/views.js").Placed} Placed */
/**
 * @typedef {object} Edge  A line between two panes.
 * @property {string} pane  The pane before it, which it resizes: a view, or the form.
 * @property {string} label
 * @property {boolean} upright
 * @property {string} before  Selector of the pane before it.
 * @property {string} after   Selector of the pane after it.
 * @property {import("../state/views.js").Place | null} place  Area of the pane after it; null at the form.
 * @property {number} minBefore  Minimum size of the pane before it, in CSS pixels.
 * @property {number} minAfter   Minimum size of the pane after it.
 */

/** Minimum widths of the form, of all views next to it, and of one view next to another, in CSS pixels. */
const [MIN_FORM_PX, MIN_VIEWS_PX, MIN_VIEW_PX] = [270, 480, 200];
/** Maximum saved width of the form, in CSS pixels. */
const MAX_FORM_PX = 4000;

const BANDS = bandsOf(PLACED);
/** @type {Edge} */
const FORM_EDGE = {
  pane: "form",
  label: "Width of the form",
  upright: true,
  before: "#sheet",
  after: "#views",
  place: null,
  minBefore: MIN_FORM_PX,
  minAfter: MIN_VIEWS_PX,
};
/** The edges: next to the form, below each band except the last, and between neighbors in a band. @type {Edge[]} */
export const EDGES = [
  FORM_EDGE,
  ...BANDS.slice(1).map(([after], at) => between(firstOf(BANDS[at][BANDS[at].length - 1]), after, false)),
  ...BANDS.flatMap((band) =>
    band
      .slice(1)
      .flatMap((after, at) => (after.place.area === band[at].place.area ? [] : [between(band[at], after, true)])),
  ),
];

/** The first view of an area, which represents all views of the area. @param {Placed} view */
function firstOf({ place }) {
  return /** @type {Placed} */ (PLACED.find((each) => each.place.area === place.area));
}

/** @param {Placed} before @param {Placed} after @param {boolean} upright @returns {Edge} */
function between(before, after, upright) {
  const areaSelector = (/** @type {Placed} */ { place }) =>
    `:is(${PLACED.filter((each) => each.place.area === place.area)
      .map(({ name }) => `#view-${name}`)
      .join(", ")})`;
  return {
    pane: before.name,
    label: `${upright ? "Width" : "Height"} of ${before.title.toLowerCase()}`,
    upright,
    before: areaSelector(before),
    after: areaSelector(after),
    place: after.place,
    minBefore: upright ? MIN_VIEW_PX : before.place.min_px,
    minAfter: upright ? MIN_VIEW_PX : after.place.min_px,
  };
}

/** @param {string} view */
const hasArea = (view) => PLACED.some(({ name }) => name === view);

/** The view that fills the screen: an open view without an area, or the maximized one. @param {State} state */
export function largestOf({ view, panes: { largest, open }, emptyViews }) {
  if (!hasArea(view)) return view;
  return largest && emptyViews.includes(largest) && !open.includes(largest) ? null : largest;
}

/** The area of a view in the grid. @param {string | null} view */
export function areaOf(view) {
  return PLACED.find(({ name }) => name === view)?.place.area ?? view ?? "";
}

/** The visible views, one per area. @param {State} state */
export function shownViews(state) {
  return PLACED.filter(({ name, place }) => visibleViewOf(state, place.area) === name);
}

/** Whether only the header of a view is shown: it is folded, or empty. @param {State} state @param {string} view */
export function isSmall(state, view) {
  if (largestOf(state) !== null) return false;
  return state.panes.folded.includes(view) || (state.emptyViews.includes(view) && !state.panes.open.includes(view));
}

/** Folds or unfolds a view; an empty view can be unfolded, too. @param {State} state @param {string} view @returns {Partial<Panes>} */
export function folded(state, view) {
  const { panes, emptyViews } = state;
  const without = (/** @type {string[]} */ list) => list.filter((each) => each !== view);
  const small = isSmall(state, view);
  const isEmpty = emptyViews.includes(view);
  return {
    largest: null,
    folded: small || isEmpty ? without(panes.folded) : [...panes.folded, view],
    open: small && isEmpty ? [...panes.open, view] : without(panes.open),
  };
}

/** @param {State} state @param {string} view @returns {Partial<Panes>} */
export function maximized({ emptyViews, panes }, view) {
  return {
    open: emptyViews.includes(view) && !panes.open.includes(view) ? [...panes.open, view] : panes.open,
    largest: areaOf(panes.largest) === areaOf(view) ? null : view,
    folded: panes.folded.filter((each) => each !== view),
  };
}

/** Minimum and maximum size of the pane before an edge. @param {Edge} edge @param {number} before @param {number} after  Sizes of its panes. */
const limitsOf = ({ minBefore, minAfter }, before, after) => ({
  min: minBefore,
  max: Math.max(minBefore, before + after - minAfter),
});

/**
 * Resizes the pane before an edge; the pane after it gets the remaining size.
 * @param {Edge} edge @param {number} px @param {{before: number, after: number, heights: number[], bands: Placed[][], total: number}} sizes
 *   Sizes of its panes and of all visible bands, and the height of all views, in CSS pixels.
 * @returns {Partial<Panes>}
 */
export function resized(edge, px, { before, after, heights, bands, total }) {
  const { min, max } = limitsOf(edge, before, after);
  const both = before + after;
  const wanted = Math.round(Math.max(min, Math.min(max, px)));
  if (edge.pane === "form") return { form: wanted };
  if (edge.upright) return { columns: [wanted / both, 1 - wanted / both] };
  const at = bands.findIndex(([{ place }]) => place.band === edge.place?.band);
  const next = heights.with(at - 1, wanted).with(at, both - wanted);
  const available = Math.max(1, total - GAP_PX * (bands.length - 1));
  return { rows: next.map((height) => height / available) };
}

/** Resets the size of an edge to its default. @param {Edge} edge @returns {Partial<Panes>} */
export const unsized = ({ pane, upright }) =>
  pane === "form" ? { form: null } : upright ? { columns: null } : { rows: null };

/** The panes of an earlier visit; null if they are invalid. @param {string | null} text @returns {Partial<Panes> | null} */
export function readPanes(text) {
  try {
    const { form, rows, columns, folded, open, pulses } = JSON.parse(text ?? "null");
    const parts = (/** @type {any} */ list, /** @type {number} */ length, /** @type {number} */ max) =>
      Array.isArray(list) && list.length === length && list.every((part) => part > 0 && part < max) ? list : null;
    const views = (/** @type {any} */ list) =>
      PLACED.map(({ name }) => name).filter((view) => Array.isArray(list) && list.includes(view));
    return {
      form: form === 0 || (form >= MIN_FORM_PX && form <= MAX_FORM_PX) ? form : null,
      rows: parts(rows, BANDS.length, 4),
      columns: parts(columns, 2, 1),
      folded: views(folded),
      open: views(open),
      pulses: savedRows(pulses),
    };
  } catch {
    return null;
  }
}
