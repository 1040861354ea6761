/** The dialog of a recording: its contents, the signals of its channels, and the resulting figures. */
import { button, element, fill } from "../../dom.js";
import { openCapture } from "../../engine/capture.js";
import { readJson } from "../../state/json.js";
import { counted, si } from "../../state/number.js";
import { isStale } from "../../state/queries.js";
import { message } from "../link.js";
import { savedMap, saveMap } from "./channel_maps.js";
import { openDialog } from "./dialog.js";
import { alignment, baselineOf, importRecording, resultOf } from "./import_recording.js";
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

/** Rest after a change before the file is previewed again, in ms. */
const REST_MS = 200;
/** From this many changes on a preview takes a moment. */
const MANY = 2_000_000;

/** @param {Page} page @param {File | string} source  Or the name of a sample. @param {import("../../engine/capture.js").ReadOptions} [options] */
export async function openRecording(page, source, options) {
  const what = typeof source === "string" ? "" : ` ${source.name}, ${si(source.size, "B", 3)}`;
  const about = element("p", { "aria-live": "polite" }, `Reading${what}…`);
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
      await resultOf(page);
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
    async (most) => {
      const found = preview && (await capture.packets(typeof now().scenario.line.address === "number", most));
      return found && { packets: found, clock_hz: preview?.clock_hz ?? 1 };
    },
    (error) => refuse(message(error)),
  );
  const result = element("div", { class: "recorded", "aria-live": "polite" });
  const take = button(
    "Import",
    "Import: show the recording in all views",
    () => void importIt().catch((error) => refuse(message(error))),
  );
  take.className = "main";
  foot.prepend(take);
  /** What the file holds by these options; null where they are refused. @type {Preview | null} */
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
      const text = `${file} cannot be opened: ${message(error)}`;
      dispatch({ type: "notice", notice: { kind: "error", text, place: null } });
    }),
    ...options.nodes,
    result,
    packets.node,
  );
  if (earlier) options.restore(earlier);
  body.addEventListener("input", () => {
    clearTimeout(timer);
    options.show();
    // The preview is of other options than these.
    request += 1;
    take.disabled = true;
    timer = window.setTimeout(() => void updatePreview(), REST_MS);
  });
  void updatePreview().then(() => {
    const first = take.disabled ? options.missing(body) : take;
    if (foot.contains(document.activeElement)) (first ?? take).focus();
  });

  /** The run that a recording can be compared with. */
  function planOf() {
    const { result } = now();
    return result && !isStale(now()) ? result : null;
  }

  /** Previews the file by the options. @param {import("../../engine/capture.js").OpenRequest} aligned */
  async function updatePreview(aligned = {}) {
    const own = ++request;
    take.disabled = true;
    if (options.isWrong()) return;
    if (facts.count > MANY) fill(result, element("p", {}, `Reading ${counted(facts.count, "change")}…`));
    try {
      if (facts.count === 0) throw new Error(facts.error ?? "it contains no recording");
      if (options.needsMap())
        throw Object.assign(new Error("choose which channel is STEP, DIR, RX or TX"), { field: "map" });
      const found = await capture.preview({ ...aligned, ...options.request() });
      if (own !== request) return;
      showPreview(found);
      take.disabled = false;
    } catch (error) {
      if (own !== request) return;
      refuse(message(error), /** @type {{field?: string}} */ (error).field);
    }
  }

  /** Shows an error under the field that has to be changed, or below all. @param {string} why @param {string} [field] */
  function refuse(why, field = "") {
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

  async function importIt() {
    clearTimeout(timer);
    take.disabled = true;
    // Bytes go to the controllers of the experiment before, by its clock.
    const isReclocked = preview !== null && preview.lines.length > 0 && !options.values().clock;
    if (isReclocked) options.setClock(now().scenario.clock_hz);
    const aligned = options.alignedStep();
    const plan = aligned === null ? null : planOf();
    const compared = plan && { plan, baseline: await baselineOf(page, plan, aligned ?? 0) };
    const alignedBy = compared ? await alignment(capture, compared.baseline, preview) : {};
    // Of very many changes a preview takes a moment.
    if (isReclocked || compared) await updatePreview(alignedBy);
    if (!preview) return;
    const { map } = options.values();
    if (hasMap(facts) && map !== "") saveMap(facts.channels, map);
    const problem = await importRecording(page, file, capture, preview, compared, {
      isOpen: () => body.isConnected,
      close(isPart) {
        close(isPart);
        if (!isPart || !earlier) closeOpenFile();
        const own = options.values();
        if (isPart) holdOpen(page, file, capture, (again) => show(page, file, capture, facts, again, own));
      },
    });
    if (problem) fill(result, element("p", { class: "error" }, problem));
  }
}
