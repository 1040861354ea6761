/** The dialog of a recording: its content, the signals of its channels, and the resulting figures. */
import { button, element, fill } from "../../dom.js";
import { openCapture } from "../../engine/capture.js";
import { errorMessage } from "../../state/error_message.js";
import { readJson } from "../../state/json.js";
import { counted, si } from "../../state/number.js";
import { isStale } from "../../state/queries.js";
import { awaitResult } from "../await_result.js";
import { savedMap, saveMap } from "./channel_maps.js";
import { openDialog } from "./dialog.js";
import { alignment, baselineOf, importRecording } from "./import_recording.js";
import { createOptions } from "./options.js";
import { createPacketList } from "./packet_list.js";
import { closeOpenFile, holdOpen } from "./partial_recording.js";
import { readOptions } from "./read_options.js";
import { hasMap } from "./request.js";
import { formatText, lengthText, partText, sentence, stepsText } from "./texts.js";

/** @typedef {import("./import_recording.js").Page} Page */
/** @typedef {import("./import_recording.js").Capture} Capture */
/** @typedef {import("./import_recording.js").Preview} Preview */
/** @typedef {import("../../engine/capture.js").Facts} Facts */

/** Delay after a change before the preview is updated, in ms. */
const PREVIEW_DELAY_MS = 200;
/** A preview of more changes takes so long that a message is shown. */
const MANY_CHANGES = 2_000_000;

/** @param {Page} page @param {File | string} source  A file, or the name of a sample. @param {import("../../engine/capture.js").ReadOptions} [options] */
export async function openRecording(page, source, options) {
  const description = typeof source === "string" ? "" : ` ${source.name}, ${si(source.size, "B", 3)}`;
  const about = element("p", { "aria-live": "polite" }, `Reading${description}…`);
  const bar = element("progress", { max: "1", value: "0", "aria-label": "Read" });
  const percent = element("p", { "aria-hidden": "true" });
  const report = (/** @type {number} */ part) => {
    bar.value = part;
    percent.textContent = `${Math.floor(100 * part)} %`;
  };
  const capture = openCapture(source, report, options);
  const dialog = openDialog(() => capture.close());
  dialog.body.append(about, bar, percent);
  try {
    const facts = await capture.facts;
    if (!dialog.isOpen()) return;
    // With another base the file may be readable.
    if (facts.count === 0 && !facts.has_base) throw new Error(facts.error ?? "it contains no recording");
    const sample = capture.sample();
    if (sample) {
      const { scenario } = await page.engine.request("check", sample.scenario);
      page.dispatch({ type: "replace", scenario: readJson(scenario), origin: "shared" });
      await awaitResult(page);
    }
    if (!dialog.isOpen()) return;
    const again = (/** @type {import("../../engine/capture.js").ReadOptions} */ options) => {
      dialog.close();
      return openRecording(page, source, options);
    };
    const reading = sample ? {} : { ...options, again };
    show(page, sample?.file ?? /** @type {File} */ (source).name, capture, facts, dialog, null, reading);
  } catch (error) {
    dialog.close();
    throw error;
  }
}

/**
 * @param {Page} page @param {string} file  Its name. @param {Capture} capture @param {Facts} facts
 * @param {import("./dialog.js").Dialog} dialog @param {import("./request.js").Values | null} [earlier]  The options of its last import.
 * @param {import("./read_options.js").Reading} [reading]
 */
function show(page, file, capture, facts, { body, foot, close }, earlier = null, reading = {}) {
  const { dispatch, now } = page;
  const options = createOptions(facts, capture, planOf() !== null, () => body.dispatchEvent(new Event("input")));
  const packets = createPacketList(
    file,
    async (maxRows) => {
      const found = preview && (await capture.packets(typeof now().scenario.line.address === "number", maxRows));
      return found && { packets: found, clock_hz: preview?.clock_hz ?? 1 };
    },
    (error) => showError(errorMessage(error)),
  );
  const result = element("div", { class: "recorded", "aria-live": "polite" });
  const importButton = button(
    "Import",
    "Import: show the recording in all views",
    () => void runImport().catch((error) => showError(errorMessage(error))),
  );
  importButton.className = "main";
  foot.prepend(importButton);
  /** The preview with the current options; null if they are invalid. @type {Preview | null} */
  let preview = null;
  let timer = 0;
  /** Number of the last request; replies to older ones are dropped. */
  let request = 0;
  if (hasMap(facts)) options.setMap((reading.map === undefined && savedMap(facts.channels)) || facts.map);
  options.show();
  const notes = [
    ...(facts.error && facts.count > 0 ? [`The recording is truncated: ${facts.error}`] : []),
    ...facts.notes,
  ];
  fill(
    body,
    element("h2", {}, file),
    element("p", {}, formatText(facts)),
    ...notes.map((note) => element("p", { class: "note" }, sentence(note))),
    ...readOptions(facts, reading, (error) => {
      const text = `${file} cannot be opened: ${errorMessage(error)}`;
      dispatch({ type: "notice", notice: { kind: "error", text, location: null } });
    }),
    ...options.nodes,
    result,
    packets.node,
  );
  if (earlier) options.restore(earlier);
  body.addEventListener("input", () => {
    clearTimeout(timer);
    options.show();
    // The current preview no longer matches the options.
    request += 1;
    importButton.disabled = true;
    timer = window.setTimeout(() => void updatePreview(), PREVIEW_DELAY_MS);
  });
  void updatePreview().then(() => {
    const first = importButton.disabled ? options.missing(body) : importButton;
    if (foot.contains(document.activeElement)) (first ?? importButton).focus();
  });

  /** The run that the recording can be compared with, if any. */
  function planOf() {
    const { result } = now();
    return result && !isStale(now()) ? result : null;
  }

  /** Updates the preview. @param {import("../../engine/capture.js").OpenRequest} aligned */
  async function updatePreview(aligned = {}) {
    const own = ++request;
    importButton.disabled = true;
    if (options.isInvalid()) return;
    if (facts.count > MANY_CHANGES) fill(result, element("p", {}, `Reading ${counted(facts.count, "change")}…`));
    try {
      if (facts.count === 0) throw new Error(facts.error ?? "it contains no recording");
      if (options.needsMap())
        throw Object.assign(new Error("choose which channel is STEP, DIR, RX or TX"), { field: "map" });
      const found = await capture.preview({ ...aligned, ...options.request() });
      if (own !== request) return;
      showPreview(found);
      importButton.disabled = false;
    } catch (error) {
      if (own !== request) return;
      showError(errorMessage(error), /** @type {{field?: string}} */ (error).field);
    }
  }

  /** Shows an error at its field, or below all fields. @param {string} why @param {string} [field] */
  function showError(why, field = "") {
    preview = null;
    options.render(null);
    packets.hide();
    const text = sentence(why);
    options.clearErrors();
    if (options.fail(field, text)) fill(result);
    else fill(result, element("p", { class: "error" }, text));
  }

  /** @param {Preview} found */
  function showPreview(found) {
    preview = found;
    options.clearErrors();
    options.render(found);
    const { part, steps, lines, notes } = found;
    const partNote =
      part && `${partText(part)}; the figures cover the whole recording. Only a whole recording can be compared.`;
    const own = notes.filter((note) => !facts.notes.includes(note)).map(sentence);
    fill(
      result,
      ...[lengthText(found), ...steps.map(stepsText), ...lines].map((text) => element("p", {}, text)),
      ...[...(partNote ? [partNote] : []), ...own].map((note) => element("p", { class: "note" }, note)),
    );
    packets.reset(lines.length > 0);
  }

  async function runImport() {
    clearTimeout(timer);
    importButton.disabled = true;
    // The bytes are sent to the controllers of the previous experiment, so they need its clock.
    const usesExperimentClock = preview !== null && preview.lines.length > 0 && !options.values().clock;
    if (usesExperimentClock) options.setClock(now().scenario.clock_hz);
    const aligned = options.alignedStep();
    const plan = aligned === null ? null : planOf();
    const compared = plan && { plan, baseline: await baselineOf(page, plan, aligned ?? 0) };
    const alignedBy = compared ? await alignment(capture, compared.baseline, preview) : {};
    // Only if needed, because a preview of many changes takes long.
    if (usesExperimentClock || compared) await updatePreview(alignedBy);
    if (!preview) return;
    const { map } = options.values();
    if (hasMap(facts) && map !== "") saveMap(facts.channels, map);
    const problem = await importRecording(page, file, capture, preview, compared, {
      isOpen: () => body.isConnected,
      close(isPart) {
        close(isPart);
        if (!isPart || !earlier) closeOpenFile();
        const own = options.values();
        if (isPart) holdOpen(page, file, capture, (nextDialog) => show(page, file, capture, facts, nextDialog, own));
      },
    });
    if (problem) fill(result, element("p", { class: "error" }, problem));
  }
}
