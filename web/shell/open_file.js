/** Opens a file: a scenario, a link as text, a table of packets, saved edges or a recording (recording.js). */
import { Dropped } from "../engine/request_slots.js";
import { errorMessage } from "../state/error_message.js";
import { readJson } from "../state/json.js";
import { count, si, time } from "../state/number.js";
import { isStale } from "../state/queries.js";
import { locationAround } from "./sender_comparison.js";
import { undoHint } from "./storage.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {(problem: import("../state/types.js").Problem) => string} ProblemText  A problem as text, with the label of its field. */
/** @typedef {{engine: import("../engine/engine.js").Engine, openLink: (fragment: string) => Promise<void>, problemText: ProblemText} & import("../state/types.js").Page} Given */

/** Maximum bytes of a scenario. */
const MAX_SCENARIO = 32 << 20;
/** Maximum bytes of a table of packets, as in the core. */
const MAX_TABLE = 32 << 20;
/** The kind of a file is detected from this many of its first bytes. */
const HEAD_BYTES = 16 << 10;
/** Bytes that are read and compared at a time. */
const PIECE = 4 << 20;
/** Maximum problems in a message. */
const MAX_LISTED = 8;
/** Part `c` of a link, which contains the scenario. */
const LINK = /(?:^|[#&\s])c(?:=|%3D)\d+(?:\.|%2E)/i;

const KINDS_OF_FILES =
  "Stepscope opens: a scenario (JSON), a share link as text, a table of packets (CSV) to send again, edges (CSV or trace) to compare with this run, and recordings: VCD, sigrok sessions, tables of levels (CSV), hex dumps, serial logs, UART annotations, Klipper step commands, and tables of positions.";

/** The fragment of a link within a text. @param {string} text */
const fragmentOf = (text) =>
  text
    .slice(text.indexOf("#") + 1)
    .trim()
    .split(/\s/, 1)[0];

/** Whether a table with this first line has packets. @param {string} line */
const isPacketTable = (line) => /(^|,)start_(cycle|s)(,|\s*$)/.test(line) && /(^|,)bytes(,|\s*$)/.test(line);

/** Whether a file with this first line has edges, as CSV or trace. @param {string} line */
const isEdgeTable = (line) => /^cycle,/.test(line) || /^[0-9a-f]+ [0-9a-f]+\s*$/.test(line);

/** @param {Given} page @param {File[]} files */
export async function openFiles({ engine, openLink, problemText, dispatch, now }, files) {
  if (files.length > 1)
    return notify("error", `${files.length} files were given; open one at a time. ${KINDS_OF_FILES}`);
  return open(files[0]);

  /** @param {"info" | "error"} kind @param {string} text @param {import("../state/types.js").TraceLocation | null} [location] */
  function notify(kind, text, location = null) {
    dispatch({ type: "notice", notice: { kind, text, location } });
  }

  /** @param {File} file */
  async function open(file) {
    try {
      const head = (await file.slice(0, HEAD_BYTES).text()).replace(/^\ufeff/, "").trimStart();
      const [firstLine] = head.split("\n", 1);
      if (head.startsWith("{")) await openScenarioFile(file);
      else if (file.size <= HEAD_BYTES && LINK.test(head)) await openLink(fragmentOf(head));
      else if (isPacketTable(firstLine)) await replayPackets(file);
      else if (isEdgeTable(firstLine)) await compareEdges(file);
      else await (await import("./recording/recording.js")).openRecording({ engine, problemText, dispatch, now }, file);
    } catch (error) {
      if (!(error instanceof Dropped)) notify("error", `${file.name} cannot be opened: ${errorMessage(error)}`);
    }
  }

  /** The text of a file, unless it is too long. @param {File} file @param {number} maxBytes */
  async function textOf(file, maxBytes) {
    if (file.size > maxBytes) throw new Error(`it has ${si(file.size, "B", 3)}; use at most ${si(maxBytes, "B", 3)}`);
    return file.text();
  }

  /** @param {File} file */
  async function openScenarioFile(file) {
    await openScenario(
      await textOf(file, MAX_SCENARIO),
      file,
      (scenario) => `Opened ${scenario.title ? `“${scenario.title}” from ` : ""}${file.name}.`,
    );
  }

  /** @param {File} file */
  async function replayPackets(file) {
    const slot = "replay";
    const table = await textOf(file, MAX_TABLE);
    const text = await engine.compute(slot, "replay", table, JSON.stringify(now().scenario));
    await openScenario(
      text,
      file,
      (scenario) =>
        `The ${count(scenario.source.line.sends.length)} packets of ${file.name} are sent again to the controllers of the previous experiment, at the times of their reception. Replies are not sent again, so the run can differ.`,
    );
  }

  /** Opens a scenario if it is valid. @param {string} json @param {File} file @param {(scenario: any) => string} describe */
  async function openScenario(json, file, describe) {
    const { problems, scenario } = await engine.request("check", json);
    if (problems.length > 0) {
      const listed = problems.slice(0, MAX_LISTED).map(problemText);
      const more = problems.length > MAX_LISTED ? `; and ${problems.length - MAX_LISTED} more` : "";
      return notify(
        "error",
        `${file.name} has ${problems.length === 1 ? "a problem" : `${problems.length} problems`}: ${listed.join("; ")}${more}. Your work is unchanged.`,
      );
    }
    const read = readJson(scenario);
    if (JSON.stringify(read) === JSON.stringify(now().scenario))
      return notify("info", `${file.name} is the same as the current experiment.`);
    dispatch({ type: "replace", scenario: read, origin: "shared" });
    notify("info", `${describe(read)}${undoHint()}`);
  }

  /** Compares saved edges with the run. @param {File} file */
  async function compareEdges(file) {
    const { result } = now();
    if (!result) throw new Error("there is no run to compare with");
    if (isStale(now())) throw new Error("the current experiment has not run; fix the form or run it, then compare");
    const { controller, summary } = result;
    const comparison = await engine.session(async (request, json) => {
      await request("open", "trace_file", json, controller);
      for (let at = 0; at < file.size; at += PIECE) {
        const piece = new Uint8Array(await file.slice(at, at + PIECE).arrayBuffer());
        const differs = await request("of", "feed", piece);
        if (differs) break;
        if (at > 0) notify("info", `Comparing ${file.name}: ${Math.round((100 * at) / file.size)} %`);
      }
      return request("of", "end");
    });
    if (!comparison || now().result?.summary !== summary)
      throw new Error("the experiment has run again; compare again");
    const seconds = (/** @type {number} */ cycle) => `${time(cycle / summary.clock_hz)}`;
    const { difference } = comparison;
    if (!difference) {
      const { start_cycle, end_cycle, goes_on, same } = comparison;
      const all = start_cycle === 0 && !goes_on;
      const range = all
        ? "the whole run"
        : `this run from ${seconds(start_cycle)} to ${seconds(end_cycle)} (the file covers no more)`;
      return notify("info", `${file.name} is bit-identical: ${count(same)} rows, ${range}.`);
    }
    const { cycle, line, signals } = difference;
    const changes = signals.map(
      (/** @type {[string, number, number]} */ [name, inFile, inRun]) =>
        `${name} is ${inFile} in the file, but ${inRun} in the run`,
    );
    const what =
      changes.length > 0
        ? changes.slice(0, 4).join(", ") + (changes.length > 4 ? `, and ${changes.length - 4} more` : "")
        : "a row without a change";
    const location = locationAround(cycle, cycle, summary.end_cycle, controller);
    notify(
      "error",
      `${file.name} differs from this run: after ${count(comparison.same)} equal rows the first difference is in line ${count(line)}, cycle ${count(cycle)} (${seconds(cycle)}): ${what}.`,
      location,
    );
  }
}
