/** Restores the work of an earlier visit, and offers that of another tab. */
import { initial, OWN_TEXTS } from "../state/initial.js";
import { readJson } from "../state/json.js";
import { loadHistory, loadLastValid, loadNewer, loadPrevious, loadScenario } from "./storage.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../engine/engine.js").Engine} Engine */

/**
 * The saved work of the user, which may have problems. Undo restores the work that it replaced.
 * @param {Engine} engine @param {string} fallback  The scenario of a first visit. @param {string} version  Of the page; the history of another version is ignored.
 * @returns {Promise<{saved: State, lastValid: string | null}>}  `lastValid` is the last scenario that ran, if this one cannot.
 */
export async function savedWork(engine, fallback, version) {
  const [own, previous] = [loadScenario(), loadPrevious()];
  if (own === null) return { saved: initial(readJson(fallback)), lastValid: null };
  // If the core cannot be loaded, the scenario stays as it was saved.
  const read = (/** @type {string} */ json) =>
    engine.request("check", json).catch(() => ({ scenario: json, problems: [] }));
  const { scenario, problems } = await read(own);
  const { past, future } = loadHistory(version);
  const hasPrevious = past.length === 0 && previous !== null && previous !== own;
  const history = hasPrevious ? [momentOf((await read(previous)).scenario)] : past;
  const saved = { ...initial(readJson(scenario)), past: history, future };
  return { saved, lastValid: problems.length > 0 ? loadLastValid() : null };
}

/** @param {string} scenario @returns {import("../state/types.js").Moment} */
const momentOf = (scenario) => ({ scenario: readJson(scenario), origin: "own", borrowed: OWN_TEXTS, drafts: {} });

/** Offers work that another tab saved after this one's. @param {{engine: Engine} & import("../state/types.js").Page} page */
export async function offerNewer({ engine, dispatch }) {
  const newer = loadNewer();
  if (newer === null) return;
  const validation = await engine.request("check", newer).catch(() => null);
  if (validation === null) return;
  const scenario = readJson(validation.scenario);
  const name = scenario.title ? `, “${scenario.title}”` : "";
  const text = `Another tab has newer work${name}. This tab shows its own work.`;
  dispatch({ type: "notice", notice: { kind: "info", text, offer: { label: "Open the newer work", scenario } } });
}
