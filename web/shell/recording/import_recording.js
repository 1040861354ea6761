/** Imports a recording: its scenario, its records, and the comparison with the previous run. */
import { readJson } from "../../state/json.js";
import { count } from "../../state/number.js";
import { awaitResult } from "../await_result.js";
import { undoHint } from "../storage.js";
import { offerDifferences } from "./differences.js";
import { onceReplaced } from "./partial_recording.js";
import { saveRecording } from "./saved_recordings.js";
import { comparisonText, extendedNote, importedText, withControllers, worstLocation } from "./texts.js";

/** @typedef {import("../../engine/capture.js").Preview} Preview */
/** @typedef {ReturnType<typeof import("../../engine/capture.js").openCapture>} Capture */
/** @typedef {import("../../state/types.js").Result} Result */
/** @typedef {{engine: import("../../engine/engine.js").Engine, problemText: import("../open_file.js").ProblemText} & import("../../state/types.js").Page} Page */
/** @typedef {{records: Uint8Array, clock_hz: number, channel: number, baud: number, aligned: number}} Baseline  The run that a recording is compared with. */

/** Screens with short messages. */
const PHONE = "(max-width: 599px)";
/** The selected channel of a run as the baseline. @param {Page} page @param {Result} plan @param {number} aligned @returns {Promise<Baseline>} */
export async function baselineOf({ engine, now }, plan, aligned) {
  const { axis: channel, scenario } = now();
  const records = await engine.request("records_of", channel);
  return { aligned, records, clock_hz: plan.summary.clock_hz, channel, baud: scenario.line.baud };
}

/** The options of a preview that is aligned with a baseline. @param {Capture} capture @param {Baseline} baseline @param {Preview | null} preview */
export async function alignment(capture, baseline, preview) {
  const { aligned, channel } = baseline;
  const at_s = await capture.timeOf(baseline);
  if (typeof at_s === "number") return { at_s, channel, aligned };
  if (aligned === 0) return {};
  const noun = preview?.steps.length === 0 ? "byte" : "step";
  throw new Error(`the experiment has no ${noun} ${count(aligned)} (the first is 0); use a ${noun} that both have`);
}

/**
 * The scenario of a recording, checked by the core.
 * @param {Page} page @param {Capture} capture @param {string} note  Added to its note.
 * @returns {Promise<{scenario: string, problem: string}>}
 */
async function scenarioOf({ engine, problemText, now }, capture, note) {
  const check = (/** @type {string} */ json) => engine.request("check", json);
  const [first, ...rest] = await capture.scenarios(false);
  const isShown = rest.length === 0 || (await check(first)).problems.length === 0;
  const own = readJson(withControllers(isShown ? first : rest[0], now().scenario));
  if (note) own.note = extendedNote(own.note, note);
  const { problems, scenario } = await check(JSON.stringify(own));
  return { scenario, problem: problems.map(problemText).join("; ") };
}

/** Sets the visible run as the baseline. @param {Page} page @param {Result} plan */
async function setBaseline({ engine, dispatch, now }, { summary, controller }) {
  await engine.request("baseline", true);
  const { scenario, derived: all, revision } = now();
  const derived = all?.controllers[controller] ?? null;
  const title = scenario.title || "the experiment";
  dispatch({ type: "baseline", baseline: { title, revision, summary, controller, derived } });
}

/**
 * @param {Page} page @param {string} file  Its name. @param {Capture} capture @param {Preview} preview
 * @param {{plan: Result, baseline: Baseline} | null} compared
 * @param {{isOpen: () => boolean, close: (isPart: boolean) => void}} dialog  `isPart`: the file is still needed for other parts.
 * @returns {Promise<string>}  Why it cannot be imported; empty if it was, or if the dialog was closed meanwhile.
 */
export async function importRecording(page, file, capture, preview, compared, dialog) {
  const { engine, dispatch } = page;
  const comparison = compared && (await capture.comparison(compared.baseline));
  const difference = comparison ? comparisonText(comparison, compared.baseline.aligned) : "";
  // Without steps the simulation of the bytes shows more than the records.
  const pieces = preview.steps.length > 0 ? await capture.records(preview.records) : [];
  const { scenario, problem } = await scenarioOf(page, capture, difference);
  if (problem) return problem;
  const { line, controllers } = readJson(scenario);
  const replies = await capture.replies([line, ...controllers].map(({ address }) => address ?? 0));
  if (!dialog.isOpen()) return "";
  if (compared) await setBaseline(page, compared.plan);
  const isRecorded = pieces.length > 0;
  const hasRecords = isRecorded || replies !== undefined;
  if (hasRecords) engine.showRecording(scenario, pieces, replies?.bytes);
  dispatch({ type: "replace", scenario: readJson(scenario), origin: "shared" });
  dialog.close(isRecorded && preview.part !== null);
  const run = awaitResult(page);
  const notSaved = hasRecords ? await saveRecording(page, file, scenario, pieces, replies?.bytes) : "";
  const isShort = window.matchMedia(PHONE).matches;
  const imported = { file, part: preview.part, isRecorded, hasBaseline: compared !== null, replies, isShort };
  const text = importedText({ ...imported, own: undoHint() }) + notSaved;
  dispatch({ type: "notice", notice: { kind: "info", text, location: null } });
  if (!comparison) return "";
  onceReplaced(page, offerDifferences(page, comparison));
  const shown = await run;
  if (!shown) return "";
  const location = worstLocation(comparison, shown);
  dispatch({ type: "notice", notice: { kind: "info", text: `${difference} ${text}`, location } });
  return "";
}
