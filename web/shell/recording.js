/**
 * The dialog of a recording: what its file holds, which channel is which signal, and the resulting figures. Importing it puts it
 * in place of the experiment. What the file does not say is requested, never guessed.
 */
import { button, byId, element, fill, say } from "../dom.js";
import { openCapture } from "../engine/capture.js";
import { readJson } from "../state/json.js";
import { count, counted, plain, si, time } from "../state/number.js";
import { isStale } from "../state/queries.js";
import { createChannelTable } from "./channel_table.js";
import { offerDifferences } from "./differences.js";
import { keep, stands } from "./kept.js";
import { message } from "./link.js";
import { choiceField, numberField, sentence, textField, timeField } from "./recording_fields.js";
import { save } from "./save.js";
import { ownIsKept } from "./storage.js";
import { around } from "./verdict.js";
import { createWhole } from "./whole.js";

/** @typedef {import("../engine/capture.js").Facts} Facts */
/** @typedef {import("../engine/capture.js").Looked} Looked */
/** @typedef {import("../engine/capture.js").Asked} Asked */
/** @typedef {{engine: import("../engine/engine.js").Engine} & import("../state/types.js").Page} Page */
/** @typedef {{numbers: number[], uart: string, from_s: number | null, to_s: number | null}} Said  The options of a file: clock, sample rate, bit rate and serial format; and its part. */

/** Maps that are kept, by the names of a file's channels. */
const MAPS = "stepscope.maps";
const MAX_MAPS = 30;
/** Formats of a serial line: data bits, parity, stop bits. @type {[string, string][]} */
const FORMATS = [
  ["8N1", "8N1 (usual)"],
  ["8E1", "8E1, even parity"],
  ["8O1", "8O1, odd parity"],
  ["8N2", "8N2, 2 stop bits"],
  ["7N1", "7N1, 7 data bits"],
  ["7E1", "7E1, even parity"],
  ["7O1", "7O1, odd parity"],
  ["7N2", "7N2, 2 stop bits"],
  ["8E2", "8E2"],
  ["8O2", "8O2"],
  ["7E2", "7E2"],
  ["7O2", "7O2"],
];
/** Where a message is as short as it can be. */
const PHONE = "(max-width: 599px)";
/** Rest after a change before it is looked again, in ms. */
const REST_MS = 200;
/** Packets that the dialog lists, and bytes that it lists of each; its file has all. */
const [MAX_LISTED, MAX_LISTED_BYTES] = [100, 32];
/** From so many changes on looking at them takes a moment. */
const MANY = 2_000_000;
/** Greatest drift that is told of two clocks. */
const MAX_DRIFT_PPM = 50_000;
/** Differences from the baseline that the message names. */
const MAX_DIFFERENCES = 3;
/** Characters that a note can have; a longer one would be refused. */
const MAX_NOTE = 2000;
/** How long the experiment before may run, in ms. */
const PATIENCE_MS = 60_000;

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
  const dialog = dialogOf(() => capture.close());
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

/** A dialog with what it says and its buttons. @param {() => void} leave  It is closed, and what it is of is no longer needed. */
function dialogOf(leave) {
  const close = (isNeeded = false) => {
    if (!isNeeded) leave();
    dialog.close();
    dialog.remove();
  };
  const body = element("div", {});
  const cancel = button("Cancel", "Cancel: leave the file; the experiment stays", () => close());
  const foot = element("p", { class: "named" }, cancel);
  const dialog = element("dialog", { class: "recording", "aria-label": "Recording" }, body, foot);
  dialog.addEventListener("cancel", () => close());
  document.body.append(dialog);
  dialog.showModal();
  return { body, foot, close, isOpen: () => dialog.open };
}

/** The file whose part is on show. `letGo` takes its button away; `leave` gives the file up, too. @type {{letGo: () => void, leave: () => void} | null} */
let held = null;

/** Calls back once the experiment is another one. Returns how to stop that. @param {Page} page @param {() => void} left */
function whileShown({ now }, left) {
  const own = stands(now().scenario);
  // The page updates this attribute whenever its experiment changes.
  const watch = new MutationObserver(() => {
    if (stands(now().scenario) === own) return;
    watch.disconnect();
    left();
  });
  watch.observe(document.documentElement, { attributeFilter: ["data-state"] });
  return () => watch.disconnect();
}

/** Leaves the file whose part was on show. */
function leaveHeld() {
  held?.leave();
  held = null;
}

/**
 * Of a file a part is on show: another one can be chosen, and nothing is read again, until something else takes its place.
 * @param {Page} page @param {string} file @param {ReturnType<typeof openCapture>} capture @param {Facts} facts @param {Said} said
 */
function holdFor(page, file, capture, facts, said) {
  held?.letGo();
  let close = () => {};
  const again = button("Another part…", `Show another part of ${file}`, () => {
    const dialog = dialogOf(() => {});
    close = dialog.close;
    show(page, file, capture, facts, dialog, said);
  });
  const stop = whileShown(page, leaveHeld);
  const letGo = () => {
    stop();
    again.remove();
  };
  const leave = () => {
    letGo();
    close();
    capture.close();
  };
  byId("on-show").append(" ", again);
  held = { letGo, leave };
}

/** The result of the experiment as it stands, once it has run; null where that does not come. @param {Page} page */
async function resultOf({ now }) {
  const { revision } = now();
  for (let waited = 0; waited < PATIENCE_MS && now().revision === revision; waited += REST_MS) {
    const { result } = now();
    if (result?.revision === revision) return result;
    await new Promise((rested) => setTimeout(rested, REST_MS));
  }
  return null;
}

/**
 * @param {Page} page @param {string} file  Its name. @param {ReturnType<typeof openCapture>} capture @param {Facts} facts
 * @param {ReturnType<typeof dialogOf>} dialog @param {Said | null} [earlier]  What was said of it before.
 * @param {{map?: string, again?: (map: string) => Promise<void>}} [reading]  The map it was read for, and how to read it for another one.
 */
function show(page, file, capture, facts, { body, foot, close }, earlier = null, { map, again } = {}) {
  const { engine, dispatch, now } = page;
  const { format, channels } = facts;
  const table = createChannelTable(channels);
  const isBytes = facts.has_bytes;
  const clock = numberField("Clock", "Hz", "from the file");
  const rate = numberField("Sample rate", "Hz", "required");
  const baud = numberField("Bit rate", "baud", facts.has_times || !isBytes ? "measured" : "required");
  const uart = choiceField("Serial format", FORMATS);
  const fields = [rate, baud, uart, clock];
  // Bytes without times are back to back at the bit rate, unless the core requests the length of a sample.
  rate.label.hidden = facts.has_times || isBytes;
  // Levels, and decoded bytes of several lines.
  const hasMap = facts.has_levels || channels.length > 1;
  const mapError = element("p", { class: "error", "aria-live": "polite" });
  /** Where the core's errors go, by what has to be changed. @type {{[field: string]: (message: string) => void}} */
  const remedies = {
    map: (text) => say(mapError, text),
    clock_hz: clock.fail,
    sample_rate_hz: rate.fail,
    baud: baud.fail,
    uart: uart.fail,
  };
  const result = element("div", { class: "recorded", "aria-live": "polite" });
  const said = element("details", { class: "packets-said" });
  said.addEventListener("toggle", () => {
    if (said.open) void listPackets().catch((error) => refuse(message(error)));
  });
  said.hidden = true;
  const plan = planOf();
  const besides = element("input", { id: "recording-beside", type: "checkbox", ...(plan ? { checked: "" } : {}) });
  const beside = element("label", { class: "check" }, besides, ` Compare with this experiment`);
  const align = numberField("Aligned by step", "", "0, the first", 0);
  const isWrong = () =>
    table.isWrong() || [...fields, from, to, align].some(({ label, isWrong }) => !label.hidden && isWrong());
  const from = timeField("Show from", "its beginning");
  const to = timeField("Show up to", "as far as there is room");
  const whole = createWhole(capture, (part) => {
    from.set(part?.from_s ?? null);
    to.set(part?.to_s ?? null);
    body.dispatchEvent(new Event("input"));
  });
  let isChoosing = false;
  const byTimes = button("Show a part…", "Show a part of it: by its times", () => {
    isChoosing = true;
    showFields();
    from.label.querySelector("input")?.focus();
  });
  /** What depends on what was looked at: a part is not laid beside anything. @param {Looked["kept"]} kept */
  const showFields = (kept = looked?.kept ?? null) => {
    const isPart = kept !== null || from.value() !== null || to.value() !== null;
    for (const { label } of [from, to]) label.hidden = !isPart && !isChoosing;
    byTimes.hidden = whole.node.hidden || isPart || isChoosing;
    beside.hidden = plan === null || isPart;
    align.label.hidden = beside.hidden || !besides.checked;
    const hasLine = table.has("RX", "TX");
    baud.label.hidden = facts.has_levels ? !hasLine : !isBytes;
    uart.label.hidden = !facts.has_levels || !hasLine;
  };
  const take = button(
    "Import",
    "Import: show the recording in all views",
    () => void taken().catch((error) => refuse(message(error))),
  );
  take.className = "main";
  foot.prepend(take);
  /** @type {Looked | null} */
  let looked = null;
  let timer = 0;
  let asking = 0;
  if (hasMap) table.put((map === undefined && keptMap(channels)) || facts.map);
  showFields();
  // Of more than 64 channels those of the map are read first.
  const wanted = textField("Channel map", "STEP0=top.motor.STEP,DIR0=top.motor.DIR");
  const reread = button("Read again", "Read the file again: the channels of the map first", () => {
    if (wanted.value() === "") return wanted.fail("The map is missing; name the channels to read.");
    void again?.(wanted.value()).catch((error) => {
      const text = `${file} cannot be opened: ${message(error)}`;
      dispatch({ type: "notice", notice: { kind: "error", text, place: null } });
    });
  });
  wanted.set(map ?? "");
  if (facts.map_error) wanted.fail(sentence(facts.map_error));

  const notes = [...(facts.error ? [`Read in part: ${facts.error}`] : []), ...facts.notes];
  fill(
    body,
    element("h2", {}, file),
    element("p", {}, `${format}, ${counted(facts.count, facts.has_levels ? "change" : isBytes ? "byte" : "row")}`),
    ...notes.map((note) => element("p", { class: "note" }, sentence(note))),
    ...(again && facts.left_out > 0 ? [wanted.label, element("p", {}, reread)] : []),
    ...(hasMap ? [table.node, mapError] : []),
    element("div", { class: "fields" }, ...fields.map(({ label }) => label)),
    whole.node,
    byTimes,
    from.label,
    to.label,
    beside,
    align.label,
    result,
    said,
  );
  if (earlier) {
    for (const [place, field] of [clock, rate, baud].entries())
      if (earlier.numbers[place]) field.set(earlier.numbers[place]);
    uart.set(earlier.uart);
    from.set(earlier.from_s);
    to.set(earlier.to_s);
  }
  body.addEventListener("input", () => {
    clearTimeout(timer);
    showFields();
    // What was looked at is no longer what is asked.
    asking += 1;
    take.disabled = true;
    timer = window.setTimeout(() => void look(), REST_MS);
  });
  void look().then(() => {
    // Where something is missing, its field is first.
    const missing =
      facts.has_levels && table.map() === ""
        ? table.first
        : /** @type {HTMLElement | null} */ (body.querySelector(".fields [aria-invalid=true]"));
    const first = take.disabled ? missing : take;
    if (foot.contains(document.activeElement)) (first ?? take).focus();
  });

  /** The model that it can stand beside: when its first step comes. */
  function planOf() {
    const { result: last } = now();
    return last && !isStale(now()) ? last : null;
  }

  /** @param {Asked} more @returns {Asked} */
  function asked(more) {
    const said = { ...more };
    if (hasMap && table.map() !== "") said.map = table.map();
    if (clock.value()) said.clock_hz = clock.value();
    if (!rate.label.hidden && rate.value()) said.sample_rate_hz = BigInt(rate.value());
    if (!baud.label.hidden && baud.value()) said.baud = baud.value();
    if (!uart.label.hidden) said.uart = uart.value();
    const [from_s, to_s] = [from.value(), to.value()];
    if (from_s !== null) said.from_s = from_s;
    if (to_s !== null) said.to_s = to_s;
    return said;
  }

  /** @param {Asked} more */
  async function look(more = {}) {
    const own = ++asking;
    take.disabled = true;
    if (isWrong()) return;
    if (facts.count > MANY) fill(result, element("p", {}, `Reading ${counted(facts.count, "change")}…`));
    try {
      if (facts.has_levels && table.map() === "")
        throw Object.assign(new Error("choose which channel is STEP, DIR, RX or TX"), { field: "map" });
      const found = await capture.look(asked(more));
      if (own !== asking) return;
      looked = found;
      tell(found);
      take.disabled = false;
    } catch (error) {
      if (own !== asking) return;
      refuse(message(error), /** @type {{field?: string}} */ (error).field);
    }
  }

  /** What the lines say, as far as there is room for it. */
  async function listPackets() {
    const found = looked && (await capture.packets(typeof now().scenario.line.address === "number", MAX_LISTED));
    if (!found || !said.open) return;
    const name = `${file.replace(/\.[^.]*$/, "")}-packets.csv`;
    const all = button("Save all (CSV)", `Save all packets: ${name}`, () => save(name, "text/csv", [found.csv]));
    const more = found.total > found.rows.length ? `; the first ${count(found.rows.length)} of them:` : ":";
    const from = looked?.clock_hz ?? 1;
    const cells = (/** @type {import("../engine/capture.js").LinePacket} */ row) => [
      `${row.line} ${row.kind}`,
      time(row.start_cycle / from),
      hex(row.bytes),
      [row.meaning, row.outcome].filter((text) => text !== "").join("; "),
    ];
    fill(
      said,
      element("summary", {}, "Packets"),
      element(
        "p",
        {},
        `${counted(found.total, "packet")}, ${count(found.replies)} whole frames of the device${more} `,
        all,
      ),
      grid(["Line", "from", "bytes", "what it says"], found.rows.map(cells)),
    );
  }

  /** Shows an error under the field that has to be changed, where there is one. @param {string} why @param {string} [field] */
  function refuse(why, field = "") {
    looked = null;
    whole.render(null);
    showFields();
    said.hidden = true;
    const text = sentence(why);
    clearErrors();
    if (field === "sample_rate_hz") rate.label.hidden = false;
    if (remedies[field]) {
      remedies[field](text);
      fill(result);
    } else fill(result, element("p", { class: "error" }, text));
  }

  function clearErrors() {
    for (const fail of Object.values(remedies)) fail("");
  }

  /** @param {Looked} found */
  function tell(found) {
    const { clock_hz, rounding, end_s, kept, steps, lines, notes } = found;
    clearErrors();
    whole.render(facts.has_levels ? found : null);
    showFields(kept);
    const own = notes.filter((note) => !facts.notes.includes(note));
    const rows = steps.map(({ channel, figures: of }) =>
      element(
        "p",
        {},
        `Channel ${channel}: ${counted(of.steps, "step")}, ${count(of.right)} right and ${count(of.left)} left, ${time(of.first_s)} to ${time(of.last_s)}` +
          (of.greatest_rate_steps_s
            ? `; at most ${plain(of.greatest_rate_steps_s, "steps/s")}, at ${time(of.shortest_at_s ?? 0)}`
            : "") +
          (of.greatest_acceleration_steps_s2 ? `, and ${plain(of.greatest_acceleration_steps_s2, "steps/s²")}` : "") +
          ".",
      ),
    );
    fill(
      result,
      element("p", {}, `${time(kept?.end_s ?? end_s)} at ${si(clock_hz, "Hz", 6)}: ${rounding}.`),
      ...rows,
      ...lines.map((line) => element("p", {}, line)),
      ...(kept
        ? [
            element(
              "p",
              { class: "note" },
              `${part(kept)}; the figures are of all of it. A part is not laid beside the experiment.`,
            ),
          ]
        : []),
      ...own.map((note) => element("p", { class: "note" }, sentence(note))),
    );
    said.hidden = lines.length === 0;
    said.open = false;
    fill(said, element("summary", {}, "Packets"));
  }

  async function taken() {
    clearTimeout(timer);
    take.disabled = true;
    const base = now().scenario;
    // Bytes go to the controllers of the experiment before, by its clock.
    const isReclocked = looked !== null && looked.lines.length > 0 && !clock.value();
    if (isReclocked) clock.set(base.clock_hz);
    const model = align.label.hidden ? null : planOf();
    const channel = now().axis;
    const aligned = align.value();
    const one = looked?.steps.length === 0 ? "byte" : "step";
    const beside = model && {
      aligned,
      records: await engine.ask("records_of", channel),
      clock_hz: model.summary.clock_hz,
      channel,
      baud: base.line.baud,
    };
    const at_s = beside && (await capture.timeOf(beside));
    if (beside && aligned > 0 && typeof at_s !== "number")
      throw new Error(`the experiment has no ${one} ${count(aligned)}, from 0; align by one that both have`);
    // Of very many changes a look takes a moment.
    if (isReclocked || beside) await look(typeof at_s === "number" ? { at_s, channel, aligned } : {});
    if (!looked) return;
    const found = beside && (await capture.beside(beside));
    if (hasMap && table.map() !== "") keepMap(channels, table.map());
    const made = await capture.scenario(false);
    // Where no channel steps, there is more to see of what the model makes of the bytes.
    const pieces = looked.steps.length > 0 ? await capture.records(looked.records) : [];
    const own = readJson(withControllers(made, base));
    // Its message may be closed, and the page left: what was compared stays with the experiment.
    if (found) own.note = [...`${own.note} ${compared(found, aligned)}`].slice(0, MAX_NOTE).join("");
    const { problems, scenario } = await engine.ask("check", JSON.stringify(own));
    if (problems.length > 0) {
      fill(
        result,
        element(
          "p",
          { class: "error" },
          problems.map((/** @type {any} */ problem) => `${problem.path}: ${problem.message}`).join("; "),
        ),
      );
      return;
    }
    const { line, controllers } = readJson(scenario);
    const replies = await capture.replies([line, ...controllers].map(({ address }) => address ?? 0));
    // Cancelled meanwhile.
    if (!body.isConnected) return;
    if (model) {
      await engine.ask("baseline", true);
      const { scenario: plan, derived, revision } = now();
      const { summary, controller } = model;
      const own = derived?.controllers[controller] ?? null;
      dispatch({
        type: "baseline",
        baseline: { title: plan.title || "the experiment", revision, summary, controller, derived: own },
      });
    }
    const isKept = pieces.length > 0 || replies !== undefined;
    if (isKept) engine.record(scenario, pieces, replies?.bytes);
    dispatch({ type: "replace", scenario: readJson(scenario), origin: "shared" });
    const isPart = pieces.length > 0 && looked.kept !== null;
    close(isPart);
    if (!isPart || !earlier) leaveHeld();
    const numbers = [clock.value(), rate.value(), baud.value()];
    if (isPart)
      holdFor(page, file, capture, facts, { numbers, uart: uart.value(), from_s: from.value(), to_s: to.value() });
    const run = resultOf(page);
    const kept = isKept ? await keep(page, file, scenario, pieces, replies?.bytes) : "";
    const text = told(model !== null, pieces.length > 0, replies) + kept;
    dispatch({ type: "notice", notice: { kind: "info", text, place: null } });
    if (found) {
      const remove = offerDifferences(page, found);
      whileShown(page, remove);
    }
    const shown = found && (await run);
    if (!shown) return;
    const cycle = Math.round(found.largest.recorded_s * shown.summary.clock_hz);
    // So wide that where it should be is in sight, and some of its neighbours.
    const air = Math.round(
      Math.max(
        4 * Math.abs(found.largest.late_s) * shown.summary.clock_hz,
        (4 * shown.summary.end_cycle) / found.recorded,
      ),
    );
    const place = { ...around(cycle - air, cycle + air, shown.summary.end_cycle, shown.controller), cycle };
    dispatch({ type: "notice", notice: { kind: "info", text: `${compared(found, aligned)} ${text}`, place } });
  }

  /** @param {boolean} isBeside @param {boolean} isRecorded @param {import("../engine/capture.js").Replies | undefined} replies */
  function told(isBeside, isRecorded, replies) {
    const on = isRecorded ? "The views show what was recorded." : "The views show what the model makes of it.";
    const shown = isRecorded && looked?.kept ? ` ${part(looked.kept)}; its position begins with 0 there.` : "";
    const unknown = replies?.unknown
      ? ` Of ${counted(replies.unknown, "packet")} on TX nothing says which controller's: the first one's table has them.`
      : "";
    if (window.matchMedia(PHONE).matches) return `Opened ${file}.${shown}${unknown}${ownIsKept()}`;
    const said =
      replies &&
      (replies.bytes.length > 0
        ? " The table of packets has the replies as they were recorded."
        : " Nothing came on TX, and the table of packets has no replies.");
    return `Opened ${file}. ${on}${shown}${said ?? ""}${unknown}${isBeside ? " The experiment before stands beside it as the baseline." : ""}${ownIsKept()}`;
  }
}

/** @param {NonNullable<Looked["kept"]>} kept */
function part({ from_s, to_s, end_s, records, of }) {
  return `Shown: ${time(from_s)} to ${time(to_s)} of ${time(end_s)}, ${count(records)} of ${counted(of, "change")}`;
}

/** Each step, or byte, beside the baseline's, in one sentence. @param {any} found @param {number} aligned */
function compared(
  {
    kind,
    recorded,
    model,
    differing,
    largest,
    rms_s,
    drift_ppm,
    largest_jitter_s,
    rms_jitter_s,
    outliers,
    other_values,
    missing,
    extra,
    differences,
    rows,
  },
  aligned,
) {
  const one = kind.slice(0, -1);
  const by = aligned > 0 ? `, aligned by ${one} ${count(aligned)}` : "";
  const all =
    missing + extra === 0
      ? `all ${count(recorded)} ${kind}`
      : `${count(recorded)} ${kind}, the baseline has ${count(model)}, ${count(missing)} missing, ${count(extra)} extra; the others`;
  const listed = rows.slice(0, MAX_DIFFERENCES).map((/** @type {{text: string}} */ { text }) => text);
  const more = differences.count > listed.length ? `; ${count(differences.count)} differences in all` : "";
  const each = differences.count > 0 ? ` ${listed.join("; ")}${more}.` : "";
  const { step, late_s } = largest;
  const late =
    late_s === 0
      ? "none is off"
      : `${one} ${count(step)} (the first is 0) is off most, ${time(Math.abs(late_s))} ${late_s > 0 ? "late" : "early"}`;
  const values = other_values > 0 ? `, ${count(other_values)} have another value` : "";
  // Further apart it is another motion, not another clock.
  const drift =
    Math.abs(drift_ppm) > MAX_DRIFT_PPM
      ? ""
      : ` Drift ${drift_ppm.toFixed(1).replace(/^-(0\.0)$/, "$1")} ppm; without it ${time(largest_jitter_s)} at most, jitter ${time(rms_jitter_s)} RMS${outliers > 0 ? `, ${counted(outliers, "outlier")} excluded` : ""}.`;
  return `Compared with the baseline${by}: ${all} compared, ${count(differing)} off by more than a cycle of the clock; ${late}${values}; RMS ${time(rms_s)}.${each}${drift}`;
}

/** Bytes go to the controllers of the experiment before, where these have the same clock. @param {string} made @param {any} base */
function withControllers(made, base) {
  const { source, clock_hz, line, title, note, run_cycles } = readJson(made);
  if (!source.line || clock_hz !== base.clock_hz) return made;
  const own = { ...base.line, baud: line.baud, noise: {} };
  const controllers = base.controllers.map((/** @type {any} */ each) => ({ ...each, axes: [], packets: [] }));
  return JSON.stringify({ ...base, source, title, note, run_cycles, line: own, controllers });
}

/** @param {number[]} bytes */
function hex(bytes) {
  const listed = bytes.slice(0, MAX_LISTED_BYTES).map((byte) => byte.toString(16).padStart(2, "0"));
  return listed.join(" ") + (bytes.length > listed.length ? " …" : "");
}

/** @param {string[]} head @param {string[][]} rows */
function grid(head, rows) {
  const row = (/** @type {string[]} */ cells) => element("tr", {}, ...cells.map((text) => element("td", {}, text)));
  const names = head.map((text) => element("th", { scope: "col" }, text));
  return element(
    "table",
    { class: "channels" },
    element("thead", {}, element("tr", {}, ...names)),
    element("tbody", {}, ...rows.map(row)),
  );
}

/** @returns {[string, string][]} */
function keptMaps() {
  try {
    const kept = JSON.parse(localStorage.getItem(MAPS) ?? "[]");
    return Array.isArray(kept) ? kept : [];
  } catch {
    return [];
  }
}

/** The map that channels of these names had last. @param {string[]} channels */
function keptMap(channels) {
  return keptMaps().find(([names]) => names === JSON.stringify(channels))?.[1] ?? null;
}

/** @param {string[]} channels @param {string} map */
function keepMap(channels, map) {
  const names = JSON.stringify(channels);
  const kept = [[names, map], ...keptMaps().filter(([other]) => other !== names)].slice(0, MAX_MAPS);
  try {
    localStorage.setItem(MAPS, JSON.stringify(kept));
  } catch {
    // Private windows and full disks refuse; the page works without.
  }
}
