/** Changes of the state by validations and results of runs. */
import { MAX_CHANNELS } from "./limits.js";
import { selected } from "./queries.js";
import { clamp, endOf, requestedWindow } from "./time_window.js";

/** @typedef {import("./types.js").State} State */

/** Revision of the last valid run of an earlier visit, shown while the form has problems. */
export const EARLIER_REVISION = -1;

/** @param {State} state @param {{revision: number, validation: import("./types.js").Validation}} message @returns {State} */
export function validated(state, { revision, validation }) {
  if (revision !== state.revision) return state;
  return { ...state, validation, validated: revision, derived: validation.derived ?? state.derived };
}

/** @param {State} state @param {{revision: number, summary: import("./types.js").Summary, ms: number}} message @returns {State} */
export function done(state, { revision, summary, ms }) {
  const earlier = revision === EARLIER_REVISION && state.result === null;
  if (revision !== state.revision && !earlier) return state;
  /** @type {State["run"]} */
  const run = earlier ? state.run : { phase: "done", progress: null, message: "" };
  const derived = earlier ? null : (state.validation?.derived ?? null);
  const result = { revision, summary, ms, controller: 0, derived };
  const next = selectController({ ...state, result, run }, state.controller);
  // With another clock, a window or cursor would be at another time.
  const same = state.result?.summary.clock_hz === summary.clock_hz;
  const inside = (/** @type {number | null} */ cycle) =>
    cycle !== null && cycle <= summary.end_cycle && same ? cycle : null;
  const updated = {
    ...next,
    window: state.window && same ? clamp(state.window, summary.end_cycle) : null,
    sender: state.sender && { ...state.sender, comparison: null },
    picked: null,
    zooms: same ? state.zooms : [],
    gesture: null,
    cursors: { a: inside(state.cursors.a), b: inside(state.cursors.b) },
    markers: state.markers.map(inside),
    highlighted: null,
  };
  return state.pendingView ? showView(updated, state.pendingView) : updated;
}

/** Shows the view of a link, or stores it until there is a result. @param {State} state @param {import("./types.js").ViewPart} view @returns {State} */
export function openView(state, view) {
  return state.result?.revision === state.revision ? showView(state, view) : { ...state, pendingView: view };
}

/** Shows the view of a link as far as the run allows. @param {State} state @param {import("./types.js").ViewPart} view @returns {State} */
function showView(state, view) {
  const last = endOf(state);
  const inside = (/** @type {number | undefined} */ cycle) => (cycle !== undefined && cycle <= last ? cycle : null);
  const next = selectController(state, view.controller ?? 0);
  return {
    ...next,
    pendingView: null,
    window: view.window ? requestedWindow(view.window, last) : null,
    cursors: { a: inside(view.a), b: inside(view.b) },
    axis: Math.min(view.axis ?? 0, (selected(next)?.channels ?? 1) - 1),
    view: view.view ?? state.view,
    sides: view.sides ?? {},
    study: view.study ?? state.study,
    unit: view.unit ?? null,
    quantities: view.quantities ?? null,
  };
}

/** Selects a controller. The result becomes a new object, so that all views redraw. @param {State} state @param {number} controller @returns {State} */
export function selectController(state, controller) {
  if (!state.result) return { ...state, controller };
  const { controllers } = state.result.summary;
  const shown = Math.min(controller, controllers.length - 1);
  const { channels } = controllers[shown];
  const row = state.row < 2 * MAX_CHANNELS && state.row % MAX_CHANNELS >= channels ? 0 : state.row;
  return {
    ...state,
    controller,
    result: { ...state.result, controller: shown },
    row,
    axis: Math.min(state.axis, channels - 1),
    packet: null,
    hover: null,
    highlighted: null,
  };
}
