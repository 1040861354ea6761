/** What this device keeps: the visitor's own scenario, the last that ran, the choice of colours, the sizes of the panes. Storage may be refused; then nothing is kept. */

const SCENARIO = "stepscope.scenario";
const PREVIOUS = "stepscope.previous";
const GOOD = "stepscope.good";
const THEME = "stepscope.theme";
const GUIDED = "stepscope.guide";
const PANES = "stepscope.panes";

/** @param {string} key @returns {string | null} */
function load(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** @param {string} key @param {string} value */
function save(key, value) {
  try {
    localStorage.setItem(key, value);
  } catch {
    // Private windows and full disks refuse; the page works without.
  }
}

export const loadScenario = () => load(SCENARIO);
/** @param {string} json */
export const saveScenario = (json) => save(SCENARIO, json);
/** Keeps the saved scenario beside the one that is about to take its place, if that is another. @param {string} next */
export function setAside(next) {
  const saved = load(SCENARIO);
  if (saved !== null && saved !== next) save(PREVIOUS, saved);
}
export const loadPrevious = () => load(PREVIOUS);
/** The last own scenario that ran to its end. */
export const loadGood = () => load(GOOD);
/** @param {string} json */
export const saveGood = (json) => save(GOOD, json);
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
