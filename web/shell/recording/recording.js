/**
 * The dialog of a recording: what its file holds, which channel is which signal, and the resulting figures. Importing it puts it
 * in place of the experiment. The dialog requests what the file does not say, and never guesses it.
 */
import { button, element, fill } from "../../dom.js";
import { openCapture } from "../../engine/capture.js";
import { readJson } from "../../state/json.js";
import { counted, si } from "../../state/number.js";
import { isStale } from "../../state/queries.js";
import { message } from "../link.js";
import { savedMap, saveMap } from "./channel_maps.js";
import { openDialog } from "./dialog.js";
import { alignment, baselineOf, importRecording, resultOf } from "./import_recording.js";
import { closeOpenFile, keepOpen } from "./open_file.js";
import { createOptions } from "./options.js";
import { createPacketList } from "./packet_list.js";
import { hasMap } from "./request.js";
import { rereadParts } from "./reread.js";
import { formatText, lengthText, partText, sentence, stepsText } from "./texts.js";

/** @typedef {import("./import_recording.js").Page} Page */
/** @typedef {import("./import_recording.js").Capture} Capture */
/** @typedef {import("./import_recording.js").Preview} Preview */
/** @typedef {import("../../engine/capture.js").Facts} Facts */

/** Rest after a change before the file is previewed again, in ms. */
const REST_MS = 200;
/** From this many changes on a preview takes a moment. */
const MANY = 2_000_000;

/** @param {Page} page @param {File | string} source  Or the name of a sample. @param {string} [map]  Its channels are read first. */
export async function openRecording(page, source, map) {
  const what = typeof source === "string" ? "" : ` ${source.name}, ${si(source.size, "B", 3)}`;
  const about = element("p", { "aria-live": "polite" }, `Reading${what}…`);
  const bar = element("progress", { max: "1", value: "0", "aria-label": "Read" });
  const percent = element("p", { "aria-hidden": "true" });
  const report = (/** @type {number} */ part) => {
    bar.value = part;
    percent.textContent = `${Math.floor(100 * part)} %`;
  };
  const capture = openCapture(source, report, map);
  const dialog = openDialog(() => capture.close());
  dialog.body.append(about, bar, percent);
  try {
    const facts = await capture.facts;
    if (!dialog.isOpen()) return;
    if (facts.count === 0) throw new Error(facts.error ?? "it holds nothing that was recorded");
    const sample = capture.sample();
    if (sample) {
      const { scenario } = await page.engine.ask("check", sample.scenario);
      page.dispatch({ type: "replace", scenario: readJson(scenario), origin: "shared" });
      await resultOf(page);
    }
    if (!dialog.isOpen()) return;
    const again = (/** @type {string} */ map) => {
      dialog.close();
      return openRecording(page, source, map);
    };
    show(page, sample?.file ?? /** @type {File} */ (source).name, capture, facts, dialog, null, { map, again });
  } catch (error) {
    dialog.close();
    throw error;
  }
}

/**
 * @param {Page} page @param {string} file  Its name. @param {Capture} capture @param {Facts} facts
 * @param {import("./dialog.js").Dialog} dialog @param {import("./request.js").Values | null} [earlier]  The options of its last import.
 * @param {import("./reread.js").Reading} [reading]
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
  const notes = [...(facts.error ? [`Read in part: ${facts.error}`] : []), ...facts.notes];
  fill(
    body,
    element("h2", {}, file),
    element("p", {}, formatText(facts)),
    ...notes.map((note) => element("p", { class: "note" }, sentence(note))),
    ...rereadParts(facts, reading, (error) => {
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
    timer = window.setTimeout(() => void look(), REST_MS);
  });
  void look().then(() => {
    const first = take.disabled ? options.missing(body) : take;
    if (foot.contains(document.activeElement)) (first ?? take).focus();
  });

  /** The run that a recording can be compared with. */
  function planOf() {
    const { result } = now();
    return result && !isStale(now()) ? result : null;
  }

  /** Previews the file by the options. @param {import("../../engine/capture.js").Asked} aligned */
  async function look(aligned = {}) {
    const own = ++request;
    take.disabled = true;
    if (options.isWrong()) return;
    if (facts.count > MANY) fill(result, element("p", {}, `Reading ${counted(facts.count, "change")}…`));
    try {
      if (options.needsMap())
        throw Object.assign(new Error("choose which channel is STEP, DIR, RX or TX"), { field: "map" });
      const found = await capture.look({ ...aligned, ...options.request() });
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
    const { kept, steps, lines, notes } = found;
    const part = kept && `${partText(kept)}; the figures are of all of it. A part is not laid beside the experiment.`;
    const own = notes.filter((note) => !facts.notes.includes(note)).map(sentence);
    fill(
      result,
      ...[lengthText(found), ...steps.map(stepsText), ...lines].map((text) => element("p", {}, text)),
      ...[...(part ? [part] : []), ...own].map((note) => element("p", { class: "note" }, note)),
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
    if (isReclocked || compared) await look(alignedBy);
    if (!preview) return;
    const { map } = options.values();
    if (hasMap(facts) && map !== "") saveMap(facts.channels, map);
    const problem = await importRecording(page, file, capture, preview, compared, {
      isOpen: () => body.isConnected,
      close(isPart) {
        close(isPart);
        if (!isPart || !earlier) closeOpenFile();
        const own = options.values();
        if (isPart) keepOpen(page, file, capture, (again) => show(page, file, capture, facts, again, own));
      },
    });
    if (problem) fill(result, element("p", { class: "error" }, problem));
  }
}
