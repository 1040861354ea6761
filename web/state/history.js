/** Changes of the scenario, with undo and redo. */
import { FRESH_TIME, OWN_TEXTS } from "./initial.js";
import { get, movedTo, set } from "./paths.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").Scenario} Scenario */
/** @typedef {import("./types.js").Origin} Origin */

/** Maximum steps of undo. */
export const DEPTH = 50;
/** Prefix of an edited experiment's name until it has a name of its own. */
const CHANGED_FROM = "changed from ";
/** Maximum characters of a name. */
export const MAX_TITLE = 120;

/**
 * Drafts in a replaced part go with it, unless `moved` says where the parts went.
 * @param {State} state @param {{path: string, value: any, joins?: boolean, moved?: import("./paths.js").Moved}} message
 */
export function edit(state, { path, value, joins = false, moved = [[path, null]] }) {
  const drafts = Object.fromEntries(
    Object.entries(state.drafts).flatMap(([at, draft]) => {
      const to = movedTo(at, moved);
      return to === null ? [] : [[to, draft]];
    }),
  );
  if (Object.is(get(state.scenario, path), value)) return { ...state, drafts };
  const joined = joins && state.edited === path;
  // What was typed on the way to a valid value of the field is no step.
  const { [path]: _, ...others } = state.drafts;
  const before = joined ? state : remember({ ...state, drafts: others });
  const { scenario, borrowed } = withOwnName(state, set(state.scenario, path, value));
  return { ...changed(before, scenario, "own"), borrowed, drafts, edited: joins ? path : null };
}

/**
 * An edited preset or shared experiment gets the name "changed from …" and loses its note.
 * @param {State} state @param {Scenario} next
 */
function withOwnName({ scenario, borrowed }, next) {
  const named = next.title !== scenario.title;
  const noted = next.note !== scenario.note;
  if (named || noted)
    return { scenario: next, borrowed: { title: borrowed.title && !named, note: borrowed.note && !noted } };
  const title = borrowed.title && next.title ? changedFrom(String(next.title)) : next.title;
  const note = borrowed.note && next.note ? "" : next.note;
  if (title === next.title && note === next.note) return { scenario: next, borrowed: OWN_TEXTS };
  return { scenario: { ...next, title, note }, borrowed: OWN_TEXTS };
}

/** @param {string} title */
function changedFrom(title) {
  if (title.startsWith(CHANGED_FROM)) return title;
  return [...`${CHANGED_FROM}${title}`].slice(0, MAX_TITLE).join("");
}

/** @param {State} state @returns {import("./types.js").Moment} */
function momentOf({ scenario, origin, borrowed, drafts }) {
  return { scenario, origin, borrowed, drafts };
}

/** @param {State} state @param {import("./types.js").Moment} moment @returns {State} */
function restored(state, { scenario, origin, borrowed, drafts = {} }) {
  return { ...changed(state, scenario, origin), borrowed, drafts };
}

/** @param {State} state @returns {State} */
export function remember(state) {
  return { ...state, past: [...state.past, momentOf(state)].slice(-DEPTH), future: [] };
}

/** @param {Scenario} scenario */
const sourceKind = ({ source }) => Object.keys(source ?? {})[0];

/** @param {State} state @param {Scenario} scenario @param {Origin} origin @returns {State} */
export function changed(state, scenario, origin) {
  return {
    ...state,
    // The times of another kind of source are other times.
    ...(sourceKind(state.scenario) === sourceKind(scenario) ? {} : FRESH_TIME),
    scenario,
    origin,
    run: { phase: "waiting", progress: null, message: "" },
    revision: state.revision + 1,
    drafts: {},
    edited: null,
    notice: null,
    pendingView: null,
    sender: null,
  };
}

/** @param {State} state @returns {State} */
export function undo(state) {
  const [moment] = state.past.slice(-1);
  // Drafts that are newer than the last edit are a step of their own.
  const known = Object.values(moment?.drafts ?? {}).map(({ text }) => text);
  const drafts = Object.entries(state.drafts).filter(([, { text }]) => known.includes(text));
  const future = [...state.future, momentOf(state)].slice(-DEPTH);
  if (drafts.length < Object.keys(state.drafts).length)
    return { ...state, drafts: Object.fromEntries(drafts), edited: null, future };
  return moment ? { ...restored(state, moment), past: state.past.slice(0, -1), future } : state;
}

/** @param {State} state @returns {State} */
export function redo(state) {
  const [moment] = state.future.slice(-1);
  if (!moment) return state;
  const future = state.future.slice(0, -1);
  if (moment.scenario === state.scenario) return { ...state, drafts: moment.drafts, edited: null, future };
  return { ...restored(state, moment), past: [...state.past, momentOf(state)].slice(-DEPTH), future };
}

/** Takes the edits of a canceled gesture back. @param {State} state @param {State["future"]} future  Before the gesture. @returns {State} */
export function cancelEdit(state, future) {
  const [moment] = state.past.slice(-1);
  if (state.edited === null || !moment) return state;
  return { ...restored(state, moment), past: state.past.slice(0, -1), future };
}
