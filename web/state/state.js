/**
 * The page's state and the one function that changes it: `update(state, message)`. No DOM, no worker,
 * no clock: what follows from a change (judging, running, drawing) is done by who sends the message.
 */

import { AS_THEY_ARE } from "./row_choices.js";

/** @typedef {import("./types.js").State} State */
/** @typedef {import("./types.js").Scenario} Scenario */
/** @typedef {import("./types.js").Origin} Origin */
/** @typedef {import("./types.js").Span} Span */
/** @typedef {import("./types.js").Borrowed} Borrowed */
/** @typedef {[from: string, to: string | null][]} Moved  Where parts of the scenario went: from path to path, null where they are gone. */

/**
 * @typedef {{type: "edit", path: string, value: any, joins?: boolean, moved?: Moved}
 *   | {type: "draft", path: string, text: string, message: string}
 *   | {type: "committed"}
 *   | {type: "replace", scenario: Scenario, origin: Origin}
 *   | {type: "undo"} | {type: "redo"}
 *   | {type: "judged", revision: number, judgement: import("./types.js").Judgement}
 *   | {type: "approve"}
 *   | {type: "running"} | {type: "progress", progress: import("./types.js").Progress}
 *   | {type: "done", revision: number, summary: import("./types.js").Summary, ms: number}
 *   | {type: "failed", message: string}
 *   | {type: "window", window: Span | null, joins?: string} | {type: "back"}
 *   | {type: "box", on: boolean} | {type: "pick", picked: Span | null}
 *   | {type: "baseline", baseline: State["baseline"]} | {type: "difference", on: boolean}
 *   | {type: "harmonic", harmonic: number | null}
 *   | {type: "open", view: import("./types.js").ViewPart}
 *   | {type: "seen", text: string} | {type: "compared", text: string, verdict: import("./types.js").Verdict}
 *   | {type: "hover", cycle: number | null}
 *   | {type: "light", highlighted: State["highlighted"]}
 *   | {type: "marker", digit: number, cycle: number | null}
 *   | {type: "cursor", which: "a" | "b", cycle: number | null}
 *   | {type: "row", row: number} | {type: "packet", packet: number | null}
 *   | {type: "filter", filter: Partial<State["filter"]>}
 *   | {type: "fold", channel: number, folded: boolean} | {type: "fold-all", folded: boolean}
 *   | {type: "all-signals", on: boolean}
 *   | {type: "controller", controller: number} | {type: "side", area: string, side: string}
 *   | {type: "axis", axis: number} | {type: "unit", unit: State["unit"]}
 *   | {type: "pane", panes: Partial<import("./types.js").Panes>} | {type: "bare", view: string, bare: boolean}
 *   | {type: "rows", rows: Partial<import("./row_choices.js").RowChoices>}
 *   | {type: "view", view: string} | {type: "study", study: import("./types.js").StudyName} | {type: "notice", notice: State["notice"]}} Message
 */

/** Steps of history that are kept. */
export const DEPTH = 50;
/** Controllers that a line can have beside the first. */
export const MAX_FURTHER = 31;
/** Channels that a bus can have. */
export const MAX_CHANNELS = 16;
/** Revision of the result that an earlier visit left, shown while the form has problems. */
export const EARLIER = -1;
/** Least cycles that the time axis shows. */
export const MIN_SPAN = 16;
/** Markers 0 to 9, none of them set. @type {(number | null)[]} */
const NO_MARKERS = Array(10).fill(null);

/** All packets are shown. @type {State["filter"]} */
export const NO_FILTER = { text: "", kind: "", address: null, outcome: "", only: false };

/** Name and note are the visitor's own. @type {Borrowed} */
export const OWN_TEXTS = { title: false, note: false };
/** What an edited experiment is called until it has a name of its own; its note goes. */
export const CHANGED_FROM = "changed from ";
/** Characters that a name can have; a longer one would be refused. */
export const MAX_TITLE = 120;

/** @param {Scenario} scenario @returns {State} */
export function initial(scenario) {
  return {
    scenario,
    origin: "own",
    borrowed: OWN_TEXTS,
    revision: 0,
    edited: null,
    past: [],
    future: [],
    drafts: {},
    judgement: null,
    judged: -1,
    derived: null,
    approved: -1,
    run: { phase: "idle", progress: null, message: "" },
    result: null,
    zooms: [],
    gesture: null,
    box: false,
    picked: null,
    baseline: null,
    difference: false,
    harmonic: null,
    controller: 0,
    window: null,
    awaited: null,
    axis: 0,
    unit: "steps",
    hover: null,
    highlighted: null,
    cursors: { a: null, b: null },
    markers: NO_MARKERS,
    row: 0,
    folds: {},
    allSignals: false,
    packet: null,
    filter: NO_FILTER,
    view: "motion",
    study: "compare",
    sides: {},
    notice: null,
    panes: { form: null, rows: null, columns: null, folded: [], open: [], largest: null, pulses: AS_THEY_ARE },
    bare: [],
    seen: null,
  };
}

/** @param {State} state @param {Message} message @returns {State} */
export function update(state, message) {
  switch (message.type) {
    case "edit":
      return edit(state, message);
    case "draft": {
      const { path, text, message: said } = message;
      return { ...state, drafts: { ...state.drafts, [path]: { text, message: said } } };
    }
    case "committed":
      return state.edited === null ? state : { ...state, edited: null };
    case "replace":
      return {
        ...changed(remember(state), message.scenario, message.origin),
        borrowed: message.origin === "own" ? OWN_TEXTS : { title: true, note: true },
        ...fresh,
      };
    case "undo":
      return travel(state, "past", "future");
    case "redo":
      return travel(state, "future", "past");
    case "judged":
      return judged(state, message);
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
    case "back": {
      if (state.zooms.length === 0) return state;
      const [before] = state.zooms.slice(-1);
      return {
        ...state,
        window: before && clamp(before, endOf(state)),
        zooms: state.zooms.slice(0, -1),
        gesture: null,
      };
    }
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
      return state.result?.revision === state.revision
        ? opened(state, message.view)
        : { ...state, awaited: message.view };
    case "seen":
      return { ...state, seen: { text: message.text, verdict: null } };
    case "compared":
      return state.seen?.text === message.text
        ? { ...state, seen: { ...state.seen, verdict: message.verdict } }
        : state;
    case "hover":
      return state.hover === message.cycle ? state : { ...state, hover: message.cycle };
    case "light":
      return sameLit(state.highlighted, message.highlighted) ? state : { ...state, highlighted: message.highlighted };
    case "marker":
      return { ...state, markers: state.markers.with(message.digit, message.cycle) };
    case "cursor":
      return { ...state, cursors: { ...state.cursors, [message.which]: message.cycle } };
    case "row":
      return { ...state, row: message.row };
    case "fold":
      return { ...state, folds: { ...state.folds, [message.channel]: message.folded } };
    case "fold-all":
      return {
        ...state,
        folds: {
          ...state.folds,
          ...Object.fromEntries(Array.from({ length: MAX_CHANNELS }, (_, channel) => [channel, message.folded])),
        },
      };
    case "all-signals":
      return { ...state, allSignals: message.on };
    case "filter":
      return { ...state, filter: { ...state.filter, ...message.filter } };
    case "packet":
      return { ...state, packet: message.packet };
    case "controller":
      return lookAt(state, message.controller);
    case "side":
      return { ...state, sides: { ...state.sides, [message.area]: message.side } };
    case "axis":
      return { ...state, axis: message.axis };
    case "unit":
      return { ...state, unit: message.unit };
    case "pane":
      return { ...state, panes: { ...state.panes, ...message.panes } };
    case "bare": {
      const { view, bare } = message;
      if (state.bare.includes(view) === bare) return state;
      return { ...state, bare: bare ? [...state.bare, view] : state.bare.filter((each) => each !== view) };
    }
    case "rows":
      return { ...state, panes: { ...state.panes, pulses: { ...state.panes.pulses, ...message.rows } } };
    case "view":
      return { ...state, view: message.view };
    case "study":
      return { ...state, study: message.study };
    case "notice":
      return { ...state, notice: message.notice };
  }
}

/** What a wholly different scenario begins with. */
const fresh = {
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

/** Shows another part of the time axis. The parts before it are kept, a gesture's many as one. @param {State} state @param {{window: Span | null, joins?: string}} message @returns {State} */
function moveTo(state, { window: wanted, joins }) {
  const window = wanted && clamp(wanted, endOf(state));
  const gesture = joins ?? null;
  const same =
    window === state.window ||
    (window !== null && window.start === state.window?.start && window.end === state.window.end);
  if (same || (gesture !== null && gesture === state.gesture)) return { ...state, window, gesture };
  return { ...state, window, gesture, zooms: [...state.zooms, state.window].slice(-DEPTH) };
}

/** @param {State["highlighted"]} one @param {State["highlighted"]} other */
function sameLit(one, other) {
  return one === other || JSON.stringify(one) === JSON.stringify(other);
}

/**
 * What is typed in a part that is replaced goes with it; where `moved` says what became of the parts, it goes where
 * they go.
 * @param {State} state @param {{path: string, value: any, joins?: boolean, moved?: Moved}} message
 */
function edit(state, { path, value, joins = false, moved = [[path, null]] }) {
  const drafts = Object.fromEntries(
    Object.entries(state.drafts).flatMap(([at, draft]) => {
      const to = movedTo(at, moved);
      return to === null ? [] : [[to, draft]];
    }),
  );
  if (Object.is(get(state.scenario, path), value)) return { ...state, drafts };
  const joined = joins && state.edited === path;
  const before = joined ? state : remember(state);
  const { scenario, borrowed } = owned(state, set(state.scenario, path, value));
  return { ...changed(before, scenario, "own"), borrowed, drafts, edited: joins ? path : null };
}

/** Where a path goes when parts of the scenario move; null where it is gone. @param {string} at @param {Moved} moved */
export function movedTo(at, moved) {
  const found = moved.find(([from]) => isWithin(at, from));
  if (!found) return at;
  const [from, to] = found;
  return to === null ? null : to + at.slice(from.length);
}

/**
 * A preset or shared experiment that is edited is no longer what its name and note tell: it is "changed from" that
 * until the visitor names it, and the note goes.
 * @param {State} state @param {Scenario} next
 */
function owned({ scenario, borrowed }, next) {
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

/** Whether `path` is `outer` or a part of it: what was typed there goes with it. @param {string} path @param {string} outer */
function isWithin(path, outer) {
  return outer === "" || path === outer || path.startsWith(`${outer}.`) || path.startsWith(`${outer}[`);
}

/** @param {State} state @returns {import("./types.js").Moment} */
function momentOf({ scenario, origin, borrowed }) {
  return { scenario, origin, borrowed };
}

/** @param {State} state @returns {State} */
function remember(state) {
  return { ...state, past: [...state.past, momentOf(state)].slice(-DEPTH), future: [] };
}

/** @param {State} state @param {Scenario} scenario @param {Origin} origin @returns {State} */
function changed(state, scenario, origin) {
  const run = { .../** @type {const} */ ({ phase: "waiting", progress: null, message: "" }) };
  return {
    ...state,
    scenario,
    origin,
    run,
    revision: state.revision + 1,
    drafts: {},
    edited: null,
    notice: null,
    awaited: null,
    seen: null,
  };
}

/** @param {State} state @param {"past" | "future"} from @param {"past" | "future"} to @returns {State} */
function travel(state, from, to) {
  // A text that is no number yet was never a step of the history: going back takes it away first.
  if (from === "past" && Object.keys(state.drafts).length > 0) return { ...state, drafts: {}, edited: null };
  const moment = state[from][state[from].length - 1];
  if (!moment) return state;
  const moved = { ...changed(state, moment.scenario, moment.origin), borrowed: moment.borrowed };
  return { ...moved, [from]: state[from].slice(0, -1), [to]: [...state[to], momentOf(state)].slice(-DEPTH) };
}

/** @param {State} state @param {{revision: number, judgement: import("./types.js").Judgement}} message @returns {State} */
function judged(state, { revision, judgement }) {
  if (revision !== state.revision) return state;
  return { ...state, judgement, judged: revision, derived: judgement.derived ?? state.derived };
}

/** @param {State} state @param {{revision: number, summary: import("./types.js").Summary, ms: number}} message @returns {State} */
function done(state, { revision, summary, ms }) {
  const earlier = revision === EARLIER && state.result === null;
  if (revision !== state.revision && !earlier) return state;
  /** @type {State["run"]} */
  const run = earlier ? state.run : { phase: "done", progress: null, message: "" };
  const derived = earlier ? null : (state.judgement?.derived ?? null);
  const next = lookAt({ ...state, result: { revision, summary, ms, controller: 0, derived }, run }, state.controller);
  // An old window over a run of another length or clock would show another time.
  const same = state.result?.summary.clock_hz === summary.clock_hz;
  const kept = state.window && same ? clamp(state.window, summary.end_cycle) : null;
  const inside = (/** @type {number | null} */ c) => (c !== null && c <= summary.end_cycle && same ? c : null);
  const here = {
    ...next,
    window: kept,
    seen: state.seen && { ...state.seen, verdict: null },
    picked: null,
    zooms: same ? state.zooms : [],
    gesture: null,
    cursors: { a: inside(state.cursors.a), b: inside(state.cursors.b) },
    markers: state.markers.map(inside),
    highlighted: null,
  };
  return state.awaited ? opened(here, state.awaited) : here;
}

/** Shows what a link asks to be shown, as far as the run has it. @param {State} state @param {import("./types.js").ViewPart} view @returns {State} */
function opened(state, view) {
  const last = endOf(state);
  const inside = (/** @type {number | undefined} */ cycle) => (cycle !== undefined && cycle <= last ? cycle : null);
  const shown = lookAt(state, view.controller ?? 0);
  return {
    ...shown,
    awaited: null,
    window: view.window ? within(view.window, last) : null,
    cursors: { a: inside(view.a), b: inside(view.b) },
    axis: Math.min(view.axis ?? 0, (selected(shown)?.channels ?? 1) - 1),
    view: view.view ?? state.view,
    sides: view.sides ?? {},
    study: view.study ?? state.study,
    unit: view.unit ?? "steps",
  };
}

/** The result as another of its controllers shows it: for the views another result. @param {State} state @param {number} controller @returns {State} */
function lookAt(state, controller) {
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

/** What the run made of the controller on show; none before the first run. @param {State} state */
export function selected({ result }) {
  return result?.summary.controllers[result.controller];
}

/**
 * What follows from the scenario in the form; where it is refused, what followed from the one of the last run.
 * @param {State} state @returns {{derived: import("./types.js").Derived | null, fresh: boolean}}
 */
export function derivedShown({ judgement, drafts, result, judged, revision }) {
  const fresh = judged === revision && Boolean(judgement?.derived) && Object.keys(drafts).length === 0;
  return { derived: (fresh ? judgement?.derived : result?.derived) ?? null, fresh };
}

/** What follows from the axis that a field of the form belongs to. @param {State} state @param {string} path */
export function derivedAxis({ derived }, path) {
  const further = /^controllers\[(\d+)\]/.exec(path);
  const axis = /axes\[(\d+)\]/.exec(path);
  return derived?.controllers[further ? Number(further[1]) + 1 : 0]?.axes[axis ? Number(axis[1]) : 0];
}

/** Whether a filter of the packets asks for anything. @param {State["filter"]} filter */
export function isFiltering({ text, kind, address, outcome }) {
  return text.trim() !== "" || kind !== "" || address !== null || outcome !== "";
}

/** Last cycle of the time axis. @param {State} state */
export function endOf(state) {
  return Math.max(MIN_SPAN, state.result?.summary.end_cycle ?? MIN_SPAN);
}

/** The shown part of the time axis. @param {State} state @returns {Span} */
export function shown(state) {
  return state.window ?? { start: 0, end: endOf(state) };
}

/** Keeps a window inside the run and at least a few cycles long. @param {Span} window @param {number} last @returns {Span | null} */
export function clamp({ start, end }, last) {
  const most = Math.max(MIN_SPAN, last);
  const span = Math.min(most, Math.max(MIN_SPAN, Math.round(end - start)));
  const from = Math.min(Math.max(0, Math.round(start)), most - span);
  return Number.isFinite(from + span) ? { start: from, end: from + span } : null;
}

/** A window that a link asks for; none where it does not lie in the run or is all of it. @param {Span} window @param {number} last @returns {Span | null} */
function within(window, last) {
  const inside = window.end <= last && window.end - window.start < last;
  return inside ? clamp(window, last) : null;
}

/** Why nothing runs, if so. @param {State} state @returns {"unjudged" | "problems" | "budget" | null} */
export function held(state) {
  if (Object.keys(state.drafts).length > 0) return "problems";
  if (state.judged !== state.revision || !state.judgement) return "unjudged";
  if (state.judgement.problems.length > 0) return "problems";
  return state.judgement.cost?.over_budget && state.approved !== state.revision ? "budget" : null;
}

/** Whether the views show an earlier scenario than the form. @param {State} state */
export function isStale(state) {
  return state.result?.revision !== state.revision || Object.keys(state.drafts).length > 0;
}

/** `a.b[2].c` as its parts. @param {string} path @returns {string[]} */
export function parts(path) {
  return path.split(/[.[\]]+/).filter((part) => part !== "");
}

/** @param {any} value @param {string} path */
export function get(value, path) {
  return parts(path).reduce((inner, part) => inner?.[part], value);
}

/** A copy with one value replaced; what is not on the way is shared. @param {any} value @param {string} path @param {any} leaf */
export function set(value, path, leaf) {
  const [first, ...rest] = parts(path);
  if (first === undefined) return leaf;
  const copy = Array.isArray(value) ? [...value] : { ...value };
  copy[first] = set(copy[first], rest.join("."), leaf);
  return copy;
}
