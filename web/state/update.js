/** Changes the state of the page: `update(state, message)`, without DOM, worker or clock. */
import { cancelEdit, changed, edit, redo, remember, undo } from "./history.js";
import { FRESH_VIEW, OWN_TEXTS } from "./initial.js";
import { MAX_CHANNELS } from "./limits.js";
import { done, openView, selectController, validated } from "./result.js";
import { moveBack, moveTo } from "./time_window.js";

/** @typedef {import("./types.js").State} State */

/** @param {State} state @param {import("./message.js").Message} message @returns {State} */
export function update(state, message) {
  switch (message.type) {
    case "edit":
      return edit(state, message);
    case "draft": {
      const { path, text, message: error } = message;
      return { ...state, drafts: { ...state.drafts, [path]: { text, message: error } } };
    }
    case "committed":
      return state.edited === null ? state : { ...state, edited: null };
    case "canceled":
      return cancelEdit(state, message.future);
    case "replace":
      return {
        ...changed(remember(state), message.scenario, message.origin),
        borrowed: message.origin === "own" ? OWN_TEXTS : { title: true, note: true },
        ...FRESH_VIEW,
        opened: state.opened + 1,
      };
    case "undo":
      return undo(state);
    case "redo":
      return redo(state);
    case "validated":
      return validated(state, message);
    case "approve":
      return { ...state, approved: state.revision };
    case "running":
      return { ...state, run: { phase: "running", progress: null, message: "" } };
    case "progress":
      return { ...state, run: { ...state.run, progress: message.progress } };
    case "done":
      return done(state, message);
    case "failed":
      return { ...state, run: { phase: "failed", progress: null, message: message.message } };
    case "window":
      return moveTo(state, message);
    case "back":
      return moveBack(state);
    case "box":
      return { ...state, box: message.on, picked: null };
    case "pick":
      return { ...state, picked: message.picked };
    case "baseline":
      return { ...state, baseline: message.baseline, difference: message.baseline !== null && state.difference };
    case "harmonic":
      return state.harmonic === message.harmonic ? state : { ...state, harmonic: message.harmonic };
    case "difference":
      return { ...state, difference: message.on };
    case "open":
      return openView(state, message.view);
    case "sender":
      return { ...state, sender: { text: message.text, comparison: null } };
    case "compared":
      return state.sender?.text === message.text
        ? { ...state, sender: { ...state.sender, comparison: message.comparison } }
        : state;
    case "hover":
      return state.hover === message.cycle ? state : { ...state, hover: message.cycle };
    case "highlight":
      return JSON.stringify(state.highlighted) === JSON.stringify(message.highlighted)
        ? state
        : { ...state, highlighted: message.highlighted };
    case "marker":
      return { ...state, markers: state.markers.with(message.digit, message.cycle) };
    case "cursor":
      return { ...state, cursors: { ...state.cursors, [message.which]: message.cycle } };
    case "row":
      return { ...state, row: message.row };
    case "fold":
      return { ...state, folds: { ...state.folds, [message.channel]: message.folded } };
    case "fold-all": {
      const channels = Array.from({ length: MAX_CHANNELS }, (_, channel) => [channel, message.folded]);
      return { ...state, folds: { ...state.folds, ...Object.fromEntries(channels) } };
    }
    case "all-signals":
      return { ...state, allSignals: message.on };
    case "filter":
      return { ...state, filter: { ...state.filter, ...message.filter } };
    case "packet":
      return { ...state, packet: message.packet };
    case "controller":
      return selectController(state, message.controller);
    case "side":
      return { ...state, sides: { ...state.sides, [message.area]: message.side } };
    case "axis":
      return { ...state, axis: message.axis };
    case "axes":
      return { ...state, hiddenAxes: message.hidden };
    case "quantities":
      return { ...state, quantities: message.names };
    case "unit":
      return { ...state, unit: message.unit };
    case "pane":
      return { ...state, panes: { ...state.panes, ...message.panes } };
    case "empty": {
      const { view, isEmpty } = message;
      if (state.emptyViews.includes(view) === isEmpty) return state;
      const others = state.emptyViews.filter((each) => each !== view);
      return { ...state, emptyViews: isEmpty ? [...others, view] : others };
    }
    case "rows":
      return { ...state, panes: { ...state.panes, pulses: { ...state.panes.pulses, ...message.rows } } };
    case "view":
      // The user's choice is newer than the link that is still running.
      return {
        ...state,
        view: message.view,
        pendingView: state.pendingView && { ...state.pendingView, view: message.view },
      };
    case "study":
      return { ...state, study: message.study };
    case "notice":
      return { ...state, notice: message.notice };
  }
}
