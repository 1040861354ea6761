/** The state that the page starts with. */
import { DEFAULT_ROWS } from "./row_choices.js";

/** @typedef {import("./types.js").State} State */

/** Markers 0 to 9, none of them set. @type {(number | null)[]} */
const NO_MARKERS = Array(10).fill(null);
/** The filter that shows all packets. @type {State["filter"]} */
export const NO_FILTER = { text: "", kind: "", address: null, outcome: "", only: false };
/** Name and note of the user's own experiment. @type {import("./types.js").Borrowed} */
export const OWN_TEXTS = { title: false, note: false };

/** The part of the state that belongs to the times of a run. */
export const FRESH_TIME = {
  window: null,
  zooms: [],
  gesture: null,
  picked: null,
  cursors: { a: null, b: null },
  markers: NO_MARKERS,
};

/** The part of the state that is reset when the scenario is replaced. */
export const FRESH_VIEW = {
  ...FRESH_TIME,
  controller: 0,
  harmonic: null,
  packet: null,
  filter: NO_FILTER,
  sides: {},
  hover: null,
  highlighted: null,
  axis: 0,
  hiddenAxes: [],
  unit: null,
  quantities: null,
  row: 0,
  folds: {},
};

/** @param {import("./types.js").Scenario} scenario @returns {State} */
export function initial(scenario) {
  return {
    ...FRESH_VIEW,
    scenario,
    origin: "own",
    borrowed: OWN_TEXTS,
    revision: 0,
    opened: 0,
    edited: null,
    past: [],
    future: [],
    drafts: {},
    validation: null,
    validated: -1,
    derived: null,
    approved: -1,
    run: { phase: "idle", progress: null, message: "" },
    result: null,
    box: false,
    baseline: null,
    difference: false,
    pendingView: null,
    allSignals: false,
    view: "motion",
    study: "compare",
    notice: null,
    panes: { form: null, rows: null, columns: null, folded: [], open: [], largest: null, pulses: DEFAULT_ROWS },
    emptyViews: [],
    sender: null,
  };
}
