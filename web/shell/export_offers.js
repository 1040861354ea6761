/** The files of a run, or of the time between the cursors. */
import { count, time } from "../state/number.js";
import { isStale, selected } from "../state/queries.js";
import { baseName } from "./offers.js";
import { harmonicsTable, marginsTable, violationsTable } from "./tables.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Span} Span */
/** @typedef {import("./offers.js").Offer} Offer */
/** @typedef {import("./offers.js").Group} Group */
/** @typedef {Pick<import("../engine/engine.js").Engine, "request">} Engine */

/** Pieces of a file that become one blob, which the browser may keep on disk. */
const PIECES = 16;

/** The time ranges that can be saved: the whole run, and between the cursors. @param {State} state @param {Span | null} span @returns {[string, string][]} */
export function partsOf({ result }, span) {
  const { clock_hz = 1, end_s } = result?.summary ?? {};
  /** @type {[string, string][]} */
  const whole = [["whole", end_s === undefined ? "the whole run" : `the whole run, ${time(end_s)}`]];
  if (!span) return whole;
  return [...whole, ["cursors", `between A and B, ${time((span.end - span.start) / clock_hz)}`]];
}

/** @param {State} state */
export function statusOf(state) {
  if (!state.result) return "There is no run yet.";
  return isStale(state) ? "The views show an earlier experiment than the form. Files contain what the views show." : "";
}

/** @param {State} state @param {Engine} engine @param {Span | null} span  First and last cycle; null is the whole run. @returns {Group[]} */
export function exportOffers(state, engine, span) {
  const { result, scenario } = state;
  const controller = selected(state);
  const settings = settingsOffers(state);
  if (!result || !controller) return [{ title: "Experiment", offers: settings }];
  const { source } = scenario;
  const hasSegments = Boolean(source?.segments) || source?.motion?.engine === "segments";
  const isPanel = Boolean(source?.standalone);
  const { file, table } = makers(state, engine, span);
  // A stand-alone controller has neither ticks nor segments, and sends nothing.
  const steps = hasSegments
    ? file("segments", "-segments.csv", "text/csv", "Segment lists")
    : file("ticks", "-ticks.csv", "text/csv", "Ticks, steps per channel");
  const margins = [
    table("-margins.csv", "Driver timing: margins", "timing", marginsTable),
    table("-violations.csv", "Driver timing: violations", "timing", violationsTable),
  ];
  /** @type {Offer} */
  const script = {
    name: `${baseName(state)}-line.json`,
    type: "application/json",
    label: hasSegments ? "Scenario with its segments, JSON" : "Line script of the sent bytes, JSON",
    make: async () => [await engine.request("replay_scenario"), "\n"],
  };
  return [
    {
      title: "Signals",
      offers: [
        file("vcd", ".vcd", "text/plain", "VCD, for GTKWave, Surfer, PulseView"),
        file("edges", "-edges.csv", "text/csv", `CSV of edges, ${count(controller.records)} rows for the whole run`),
        file("trace", ".trace", "text/plain", "Trace, cycle and levels in hex"),
      ],
    },
    {
      title: "Tables, CSV",
      offers: [
        ...(isPanel ? [] : [steps]),
        table("-harmonics.csv", "Harmonics", "spectrum", harmonicsTable),
        ...(controller.violations === null ? [] : margins),
      ],
    },
    { title: "Experiment", offers: [...settings, ...(isPanel ? [] : [script])] },
  ];
}

/** @param {State} state @returns {Offer[]} */
function settingsOffers(state) {
  const { validation } = state;
  if (!validation) return [];
  const name = `${baseName(state)}.json`;
  const make = async () => [validation.scenario, "\n"];
  return [{ name, type: "application/json", label: "Scenario, JSON", make }];
}

/** Functions that create offers of files and tables of the visible controller. @param {State} state @param {Engine} engine @param {Span | null} span */
function makers(state, engine, span) {
  const { controller, summary } = /** @type {import("../state/types.js").Result} */ (state.result);
  const { controllers, end_cycle, clock_hz } = summary;
  const part = controllers.length > 1 ? `-controller-${controller + 1}` : "";
  const base = `${baseName(state)}${part}`;
  const { start, end } = span ?? { start: 0, end: end_cycle };
  const cut = span ? `-${start}-${end}` : "";
  return {
    /** @param {string} kind @param {string} suffix @param {string} type @param {string} label @returns {Offer} */
    file: (kind, suffix, type, label) => ({
      name: `${base}${cut}${suffix}`,
      type,
      label,
      make: (report) => pieces(engine, [kind, controller, start, end], report),
    }),
    /** @param {string} suffix @param {string} label @param {string} method @param {(reply: any, clockHz: number) => string} text @returns {Offer} */
    table: (suffix, label, method, text) => ({
      name: `${base}${suffix}`,
      type: "text/csv",
      label,
      make: async () => [text(await engine.request(method), clock_hz)],
    }),
  };
}

/** A file of the worker as blobs. @param {Engine} engine @param {any[]} file  Kind, controller, first and last cycle. @param {(progress: number) => void} report */
async function pieces(engine, file, report) {
  /** @type {Blob[]} */
  const blobs = [];
  /** @type {BlobPart[]} */
  let gathered = [];
  /** @type {number | null} */
  let from = 0;
  while (from !== null) {
    const piece = await engine.request("file_piece", ...file, from);
    if (!piece) throw new Error("there is no run to save");
    gathered.push(piece.bytes);
    if (gathered.length === PIECES || piece.next === null) {
      blobs.push(new Blob(gathered));
      gathered = [];
    }
    from = piece.next;
    report((from ?? piece.rows) / Math.max(1, piece.rows));
  }
  return blobs;
}

/** Bytes of a file's parts. @param {BlobPart[]} parts */
export function sizeOf(parts) {
  const size = (/** @type {BlobPart} */ part) =>
    typeof part === "string" ? part.length : part instanceof Blob ? part.size : part.byteLength;
  return parts.reduce((sum, part) => sum + size(part), 0);
}
