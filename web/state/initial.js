/** The state that the page starts with. */
import { AS_THEY_ARE } from "./row_choices.js";

/** @typedef {import("./types.js").State} State */

/** Markers 0 to 9, none of them set. @type {(number | null)[]} */
const NO_MARKERS = Array(10).fill(null);
/** All packets are shown. @type {State["filter"]} */
export const NO_FILTER = { text: "", kind: "", address: null, outcome: "", only: false };
/** Name and note are the user's. @type {import("./types.js").Borrowed} */
export const OWN_TEXTS = { title: false, note: false };

/** The part of the view that does not outlive a replaced scenario. */
export const FRESH_VIEW = {
  controller: 0,
  window: null,
  zooms: [],
  gesture: null,
  picked: null,
  harmonic: null,
  packet: null,
  filter: NO_FILTER,
  sides: {},
  hover: null,
  highlighted: null,
  cursors: { a: null, b: null },
  markers: NO_MARKERS,
  axis: 0,
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
    awaited: null,
    unit: "steps",
    allSignals: false,
    view: "motion",
    study: "compare",
    notice: null,
    panes: { form: null, rows: null, columns: null, folded: [], open: [], largest: null, pulses: AS_THEY_ARE },
    bare: [],
    seen: null,
  };
}
