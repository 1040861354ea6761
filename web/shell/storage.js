/**
 * Storage of this device: scenarios, theme, pane sizes. Work is saved per tab, and as the latest of all tabs for a
 * new tab. The page also works without storage.
 */

const SCENARIO = "stepscope.scenario";
const PREVIOUS = "stepscope.previous";
const LAST_VALID = "stepscope.good";
/** The tab that saved its work last, and when. */
const LATEST = "stepscope.latest";
const TAB = "stepscope.tab";
const THEME = "stepscope.theme";
const GUIDED = "stepscope.guide";
const PANES = "stepscope.panes";
const EXPERIMENTS = "stepscope.experiments";
const HISTORY = "stepscope.history";
const RECORDINGS = "stepscope.recordings";
/** Maximum characters of the history of a tab: half of what browsers allow. */
const MAX_HISTORY = 1 << 21;

/** @typedef {() => Storage} Scope */
/** @type {Scope} */
const allTabs = () => localStorage;
/** @type {Scope} */
const thisTab = () => sessionStorage;

/** @param {string} key @param {Scope} [scope] @returns {string | null} */
function load(key, scope = allTabs) {
  try {
    return scope().getItem(key);
  } catch {
    return null;
  }
}

/** Saves a value; returns false if the browser refuses, as in private windows and on full disks. @param {string} key @param {string} value @param {Scope} [scope] */
function save(key, value, scope = allTabs) {
  try {
    scope().setItem(key, value);
    return true;
  } catch {
    return false;
  }
}

/** A saved text as JSON; null if it is invalid. @param {string | null} text @returns {any} */
function parsed(text) {
  try {
    return JSON.parse(text ?? "null");
  } catch {
    return null;
  }
}

/** The name of this tab, which a reload keeps. */
function tab() {
  const known = load(TAB, thisTab);
  if (known !== null) return known;
  const name = `${Date.now()}.${Math.random()}`;
  save(TAB, name, thisTab);
  return name;
}

/** @param {string} key */
const loadWork = (key) => load(key, thisTab) ?? load(key);
/** @param {string} key @param {string} json */
function saveWork(key, json) {
  save(key, json, thisTab);
  save(key, json);
}

export const loadScenario = () => loadWork(SCENARIO);
/** @param {string} json */
export function saveScenario(json) {
  saveWork(SCENARIO, json);
  const latest = JSON.stringify({ tab: tab(), at: Date.now() });
  save(LATEST, latest);
  save(LATEST, latest, thisTab);
}
/** What Undo restores after another scenario was opened. */
export const undoHint = () =>
  loadScenario() === null ? " Undo restores the previous experiment." : " Undo restores your own work.";
/** Work that another tab saved after this tab; null if there is none, or if this tab has saved none. */
export function loadNewer() {
  const [own, all] = [load(LATEST, thisTab), load(LATEST)].map(parsed);
  if (!own || !all || all.tab === tab() || !(all.at > own.at)) return null;
  const newer = load(SCENARIO);
  return newer === load(SCENARIO, thisTab) ? null : newer;
}
/** Saves the current work as the previous one before another scenario replaces it. @param {string} next */
export function savePrevious(next) {
  const saved = loadScenario();
  if (saved !== null && saved !== next) saveWork(PREVIOUS, saved);
}
/** Experiments that the user saved. @returns {any[]} */
export function loadExperiments() {
  const saved = parsed(load(EXPERIMENTS));
  return Array.isArray(saved) ? saved.filter((each) => typeof each?.title === "string") : [];
}
/** Returns whether they were saved. @param {any[]} experiments */
export const saveExperiments = (experiments) => save(EXPERIMENTS, JSON.stringify(experiments));
/** @typedef {Pick<import("../state/types.js").State, "past" | "future">} History */
/** The undo and redo history of this tab, if the same version of the page saved it. @param {string} version @returns {History} */
export function loadHistory(version) {
  const saved = parsed(load(HISTORY, thisTab));
  const isValid = saved?.version === version && Array.isArray(saved.past) && Array.isArray(saved.future);
  return isValid ? saved : { past: [], future: [] };
}
/** Saves the history, as many of the latest steps as there is space for. @param {string} version @param {History} history */
export function saveHistory(version, { past, future }) {
  let left = MAX_HISTORY;
  const fitting = (/** @type {History["past"]} */ steps) => {
    const first = steps.findLastIndex((step) => {
      left -= JSON.stringify(step).length;
      return left < 0;
    });
    return steps.slice(first + 1);
  };
  save(HISTORY, JSON.stringify({ version, past: fitting(past), future: fitting(future) }), thisTab);
}
export const loadPrevious = () => loadWork(PREVIOUS);
/** The last work of the user that ran. */
export const loadLastValid = () => loadWork(LAST_VALID);
/** @param {string} json */
export const saveLastValid = (json) => saveWork(LAST_VALID, json);
export const loadTheme = () => load(THEME);
/** @param {string} theme */
export const saveTheme = (theme) => save(THEME, theme);
/** Whether the guide was started or declined. */
export const loadGuided = () => load(GUIDED) !== null;
export const saveGuided = () => save(GUIDED, "seen");
/** Sizes of the panes, as JSON. */
export const loadPanes = () => load(PANES);
/** @param {string} json */
export const savePanes = (json) => save(PANES, json);
/** The saved recordings (recording/saved_recordings.js), as JSON; null if there were none. */
export const listedRecordings = () => load(RECORDINGS);
/** Returns whether the list was saved. @param {string} json */
export const listRecordings = (json) => save(RECORDINGS, json);
