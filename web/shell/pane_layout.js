/** The layout of panes on a wide screen: edges, folded and maximized views. */
import { savedRows } from "../state/row_choices.js";
import { inPlace, PLACED } from "../state/views.js";
import { bandsOf, GAP_PX } from "./grid.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Panes} Panes */
/** @typedef {import("../state/views.js").Placed} Placed */
/**
 * @typedef {object} Edge  A line between two panes.
 * @property {string} pane  The pane before it, whose size it is: a view, or the form.
 * @property {string} label
 * @property {boolean} upright
 * @property {string} before  Selector of the pane before it.
 * @property {string} after   And of the one after it.
 * @property {import("../state/views.js").Place | null} place  Of the one after it; null for the views next to the form.
 * @property {number} least  Minimum size of the pane before it in CSS pixels.
 * @property {number} rest   Minimum size that is left for what comes after it.
 */

/** Minimum widths of the form, of all views next to it, and of one view next to another, in CSS pixels. */
const [MIN_FORM_PX, MIN_VIEWS_PX, MIN_VIEW_PX] = [270, 480, 200];
/** Maximum width of the form that is read back, in CSS pixels. */
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
  least: MIN_FORM_PX,
  rest: MIN_VIEWS_PX,
};
/** The line next to the form, those below each band but the last, and those between neighbors of a band. @type {Edge[]} */
export const EDGES = [
  FORM_EDGE,
  ...BANDS.slice(1).map(([after], at) => between(firstOf(BANDS[at][BANDS[at].length - 1]), after, false)),
  ...BANDS.flatMap((band) =>
    band
      .slice(1)
      .flatMap((after, at) => (after.place.area === band[at].place.area ? [] : [between(band[at], after, true)])),
  ),
];

/** The first of the views that share a place stands for all of them. @param {Placed} view */
function firstOf({ place }) {
  return /** @type {Placed} */ (PLACED.find((each) => each.place.area === place.area));
}

/** @param {Placed} before @param {Placed} after @param {boolean} upright @returns {Edge} */
function between(before, after, upright) {
  const all = (/** @type {Placed} */ { place }) =>
    `:is(${PLACED.filter((each) => each.place.area === place.area)
      .map(({ name }) => `#view-${name}`)
      .join(", ")})`;
  return {
    pane: before.name,
    label: `${upright ? "Width" : "Height"} of ${before.title.toLowerCase()}`,
    upright,
    before: all(before),
    after: all(after),
    place: after.place,
    least: upright ? MIN_VIEW_PX : before.place.least_px,
    rest: upright ? MIN_VIEW_PX : after.place.least_px,
  };
}

/** @param {string} view */
const hasPlace = (view) => PLACED.some(({ name }) => name === view);

/** The view that fills the screen: one without a place while it is open, or one that was maximized. @param {State} state */
export function largestOf({ view, panes: { largest, open }, bare }) {
  if (!hasPlace(view)) return view;
  return largest && bare.includes(largest) && !open.includes(largest) ? null : largest;
}

/** The place of a view in the grid. @param {string | null} view */
export function areaOf(view) {
  return PLACED.find(({ name }) => name === view)?.place.area ?? view ?? "";
}

/** The visible views, one per place. @param {State} state */
export function shownViews(state) {
  return PLACED.filter(({ name, place }) => inPlace(state, place.area) === name);
}

/** Whether a view is only its head: folded, or with nothing to show. @param {State} state @param {string} view */
export function isSmall(state, view) {
  if (largestOf(state) !== null) return false;
  return state.panes.folded.includes(view) || (state.bare.includes(view) && !state.panes.open.includes(view));
}

/** A view that has nothing to show can be unfolded, too, and folded again. @param {State} state @param {string} view @returns {Partial<Panes>} */
export function folded(state, view) {
  const { panes, bare } = state;
  const without = (/** @type {string[]} */ list) => list.filter((each) => each !== view);
  const small = isSmall(state, view);
  const isBare = bare.includes(view);
  return {
    largest: null,
    folded: small || isBare ? without(panes.folded) : [...panes.folded, view],
    open: small && isBare ? [...panes.open, view] : without(panes.open),
  };
}

/** @param {State} state @param {string} view @returns {Partial<Panes>} */
export function maximized({ bare, panes }, view) {
  return {
    open: bare.includes(view) && !panes.open.includes(view) ? [...panes.open, view] : panes.open,
    largest: areaOf(panes.largest) === areaOf(view) ? null : view,
    folded: panes.folded.filter((each) => each !== view),
  };
}

/** Sizes that an edge can be moved to. @param {Edge} edge @param {number} before @param {number} after  Sizes of its panes. */
const limitsOf = ({ least, rest }, before, after) => ({
  least,
  most: Math.max(least, before + after - rest),
});

/**
 * Gives the pane before an edge a size; the one after it has the rest.
 * @param {Edge} edge @param {number} px @param {{before: number, after: number, heights: number[], bands: Placed[][], room: number}} sizes
 *   Of its panes, and of the shown bands in a room of this many CSS pixels.
 * @returns {Partial<Panes>}
 */
export function resized(edge, px, { before, after, heights, bands, room }) {
  const { least, most } = limitsOf(edge, before, after);
  const both = before + after;
  const wanted = Math.round(Math.max(least, Math.min(most, px)));
  if (edge.pane === "form") return { form: wanted };
  if (edge.upright) return { columns: [wanted / both, 1 - wanted / both] };
  const at = bands.findIndex(([{ place }]) => place.band === edge.place?.band);
  const next = heights.with(at - 1, wanted).with(at, both - wanted);
  const free = Math.max(1, room - GAP_PX * (bands.length - 1));
  return { rows: next.map((height) => height / free) };
}

/** The size as the list of views has it. @param {Edge} edge @returns {Partial<Panes>} */
export const unsized = ({ pane, upright }) =>
  pane === "form" ? { form: null } : upright ? { columns: null } : { rows: null };

/** The panes of an earlier visit; null where they cannot be read. @param {string | null} text @returns {Partial<Panes> | null} */
export function readPanes(text) {
  try {
    const { form, rows, columns, folded, open, pulses } = JSON.parse(text ?? "null");
    const parts = (/** @type {any} */ list, /** @type {number} */ length, /** @type {number} */ most) =>
      Array.isArray(list) && list.length === length && list.every((part) => part > 0 && part < most) ? list : null;
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
