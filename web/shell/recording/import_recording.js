/** Imports a recording: its scenario, its records, and the comparison with the previous run. */
import { readJson } from "../../state/json.js";
import { count } from "../../state/number.js";
import { undoHint } from "../storage.js";
import { offerDifferences } from "./differences.js";
import { whileShown } from "./partial_recording.js";
import { saveRecording } from "./saved_recordings.js";
import { comparisonText, extendedNote, importedText, withControllers, worstPlace } from "./texts.js";

/** @typedef {import("../../engine/capture.js").Preview} Preview */
/** @typedef {ReturnType<typeof import("../../engine/capture.js").openCapture>} Capture */
/** @typedef {import("../../state/types.js").Result} Result */
/** @typedef {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} Page */
/** @typedef {{records: Uint8Array, clock_hz: number, channel: number, baud: number, aligned: number}} Baseline  The run that a recording is compared with. */

/** Where messages are as short as possible. */
const PHONE = "(max-width: 599px)";
/** Maximum time that a run may take, in ms, and the time between two looks for it. */
const [MAX_RUN_MS, POLL_MS] = [60_000, 200];

/** The result of the experiment as it is now, once it has run; null if there is none. @param {import("../../state/types.js").Page} page */
export async function resultOf({ now }) {
  const { revision } = now();
  for (let waited = 0; waited < MAX_RUN_MS && now().revision === revision; waited += POLL_MS) {
    const { result } = now();
    if (result?.revision === revision) return result;
    await new Promise((resolve) => setTimeout(resolve, POLL_MS));
  }
  return null;
}

/** The selected channel of a run, to be compared with. @param {Page} page @param {Result} plan @param {number} aligned @returns {Promise<Baseline>} */
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
  const one = preview?.steps.length === 0 ? "byte" : "step";
  throw new Error(`the experiment has no ${one} ${count(aligned)} (the first is 0); align by one that both have`);
}

/**
 * The scenario that a recording is shown with, checked by the core.
 * @param {Page} page @param {Capture} capture @param {string} note  Added to its own.
 * @returns {Promise<{scenario: string, problem: string}>}
 */
async function scenarioOf({ engine, now }, capture, note) {
  const own = readJson(withControllers(await capture.scenario(false), now().scenario));
  if (note) own.note = extendedNote(own.note, note);
  const { problems, scenario } = await engine.request("check", JSON.stringify(own));
  const texts = problems.map(
    (/** @type {import("../../state/types.js").Problem} */ { path, message }) => `${path}: ${message}`,
  );
  return { scenario, problem: texts.join("; ") };
}

/** Makes the visible run the baseline. @param {Page} page @param {Result} plan */
async function takeBaseline({ engine, dispatch, now }, { summary, controller }) {
  await engine.request("baseline", true);
  const { scenario, derived: all, revision } = now();
  const derived = all?.controllers[controller] ?? null;
  const title = scenario.title || "the experiment";
  dispatch({ type: "baseline", baseline: { title, revision, summary, controller, derived } });
}

/**
 * @param {Page} page @param {string} file  Its name. @param {Capture} capture @param {Preview} preview
 * @param {{plan: Result, baseline: Baseline} | null} compared
 * @param {{isOpen: () => boolean, close: (isPart: boolean) => void}} dialog  `isPart` says that the file is still needed.
 * @returns {Promise<string>}  Why it cannot be shown; empty where it is, or where the dialog was closed meanwhile.
 */
export async function importRecording(page, file, capture, preview, compared, dialog) {
  const { engine, dispatch } = page;
  const comparison = compared && (await capture.comparison(compared.baseline));
  const difference = comparison ? comparisonText(comparison, compared.baseline.aligned) : "";
  // Without steps the model's view of the bytes shows more.
  const pieces = preview.steps.length > 0 ? await capture.records(preview.records) : [];
  const { scenario, problem } = await scenarioOf(page, capture, difference);
  if (problem) return problem;
  const { line, controllers } = readJson(scenario);
  const replies = await capture.replies([line, ...controllers].map(({ address }) => address ?? 0));
  if (!dialog.isOpen()) return "";
  if (compared) await takeBaseline(page, compared.plan);
  const isRecorded = pieces.length > 0;
  const hasRecords = isRecorded || replies !== undefined;
  if (hasRecords) engine.record(scenario, pieces, replies?.bytes);
  dispatch({ type: "replace", scenario: readJson(scenario), origin: "shared" });
  dialog.close(isRecorded && preview.part !== null);
  const run = resultOf(page);
  const notSaved = hasRecords ? await saveRecording(page, file, scenario, pieces, replies?.bytes) : "";
  const isShort = window.matchMedia(PHONE).matches;
  const imported = { file, part: preview.part, isRecorded, hasBaseline: compared !== null, replies, isShort };
  const text = importedText({ ...imported, own: undoHint() }) + notSaved;
  dispatch({ type: "notice", notice: { kind: "info", text, place: null } });
  if (!comparison) return "";
  whileShown(page, offerDifferences(page, comparison));
  const shown = await run;
  if (!shown) return "";
  const place = worstPlace(comparison, shown);
  dispatch({ type: "notice", notice: { kind: "info", text: `${difference} ${text}`, place } });
  return "";
}
