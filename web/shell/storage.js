/**
 * Storage of this device: scenarios, theme, pane sizes. Work is saved per tab, and as the latest of all tabs for a
 * new tab. The page also works without storage.
 */

const SCENARIO = "stepscope.scenario";
const PREVIOUS = "stepscope.previous";
const GOOD = "stepscope.good";
/** Which tab the work that is kept for all is of, and when it was kept. */
const LATEST = "stepscope.latest";
const TAB = "stepscope.tab";
const THEME = "stepscope.theme";
const GUIDED = "stepscope.guide";
const PANES = "stepscope.panes";
const EXPERIMENTS = "stepscope.experiments";
const HISTORY = "stepscope.history";
const RECORDINGS = "stepscope.recordings";
/** Characters of the history that a tab keeps: half of what a browser allows. */
const MAX_HISTORY = 1 << 21;

/** @typedef {() => Storage} Place */
/** @type {Place} */
const ofAll = () => localStorage;
/** @type {Place} */
const ofTab = () => sessionStorage;

/** @param {string} key @param {Place} [place] @returns {string | null} */
function load(key, place = ofAll) {
  try {
    return place().getItem(key);
  } catch {
    return null;
  }
}

/** Whether it is kept: private windows and full disks refuse, and the page works without. @param {string} key @param {string} value @param {Place} [place] */
function save(key, value, place = ofAll) {
  try {
    place().setItem(key, value);
    return true;
  } catch {
    return false;
  }
}

/** What a text that is kept says; nothing where it is not what this page writes. @param {string | null} text @returns {any} */
function parsed(text) {
  try {
    return JSON.parse(text ?? "null");
  } catch {
    return null;
  }
}

/** This tab's name, the same after a reload. */
function tab() {
  const known = load(TAB, ofTab);
  if (known !== null) return known;
  const name = `${Date.now()}.${Math.random()}`;
  save(TAB, name, ofTab);
  return name;
}

/** @param {string} key */
const loadWork = (key) => load(key, ofTab) ?? load(key);
/** @param {string} key @param {string} json */
function saveWork(key, json) {
  save(key, json, ofTab);
  save(key, json);
}

export const loadScenario = () => loadWork(SCENARIO);
/** @param {string} json */
export function saveScenario(json) {
  saveWork(SCENARIO, json);
  const latest = JSON.stringify({ tab: tab(), at: Date.now() });
  save(LATEST, latest);
  save(LATEST, latest, ofTab);
}
/** What there is to say of what was shown before, where something else takes its place. */
export const undoHint = () =>
  loadScenario() === null ? " Undo restores the previous experiment." : " Undo restores your own work.";
/** The work that another tab kept after this one's; null if there is none, or this tab has none of its own. */
export function loadNewer() {
  const [own, all] = [load(LATEST, ofTab), load(LATEST)].map(parsed);
  if (!own || !all || all.tab === tab() || !(all.at > own.at)) return null;
  const newer = load(SCENARIO);
  return newer === load(SCENARIO, ofTab) ? null : newer;
}
/** Keeps the saved scenario beside the one that is about to take its place, if that is another. @param {string} next */
export function setAside(next) {
  const saved = loadScenario();
  if (saved !== null && saved !== next) saveWork(PREVIOUS, saved);
}
/** Experiments that the user named. @returns {any[]} */
export function loadExperiments() {
  const saved = parsed(load(EXPERIMENTS));
  return Array.isArray(saved) ? saved.filter((each) => typeof each?.title === "string") : [];
}
/** Whether they are kept. @param {any[]} experiments */
export const saveExperiments = (experiments) => save(EXPERIMENTS, JSON.stringify(experiments));
/** @typedef {Pick<import("../state/types.js").State, "past" | "future">} History */
/** Steps back and forth of this tab, of the same version of the page. @param {string} version @returns {History} */
export function loadHistory(version) {
  const saved = parsed(load(HISTORY, ofTab));
  const whole = saved?.version === version && Array.isArray(saved.past) && Array.isArray(saved.future);
  return whole ? saved : { past: [], future: [] };
}
/** Keeps as many steps as there is space for, the nearest ones. @param {string} version @param {History} history */
export function saveHistory(version, { past, future }) {
  let left = MAX_HISTORY;
  const near = (/** @type {History["past"]} */ steps) => {
    const first = steps.findLastIndex((step) => {
      left -= JSON.stringify(step).length;
      return left < 0;
    });
    return steps.slice(first + 1);
  };
  save(HISTORY, JSON.stringify({ version, past: near(past), future: near(future) }), ofTab);
}
export const loadPrevious = () => loadWork(PREVIOUS);
/** The last own scenario that ran to its end. */
export const loadGood = () => loadWork(GOOD);
/** @param {string} json */
export const saveGood = (json) => saveWork(GOOD, json);
export const loadTheme = () => load(THEME);
/** @param {string} theme */
export const saveTheme = (theme) => save(THEME, theme);
/** Whether the guide was seen, or declined for ever. */
export const loadGuided = () => load(GUIDED) !== null;
export const saveGuided = () => save(GUIDED, "seen");
/** Sizes of the panes, as JSON. */
export const loadPanes = () => load(PANES);
/** @param {string} json */
export const savePanes = (json) => save(PANES, json);
/** The saved recordings (recording/saved_recordings.js), as JSON; null where there never was one. */
export const listedRecordings = () => load(RECORDINGS);
/** Whether the list is kept. @param {string} json */
export const listRecordings = (json) => save(RECORDINGS, json);
