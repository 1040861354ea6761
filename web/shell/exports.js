/**
 * Export: the run, or what lies between the cursors A and B, as files. The worker makes long ones in pieces, so
 * that ten million edges neither stop the page nor fill its memory.
 */
import { byId, element, fill, options, say } from "../dom.js";
import { Dropped } from "../engine/engine.js";
import { count, si, time } from "../state/number.js";
import { isStale, selected } from "../state/queries.js";
import { message } from "./link.js";
import { baseName, between } from "./offers.js";
import { save } from "./save.js";
import { harmonicsTable, marginsTable, violationsTable } from "./tables.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Span} Span */
/** @typedef {import("../engine/engine.js").Engine} Engine */
/** @typedef {import("./offers.js").Offer} Offer */
/** @typedef {import("./offers.js").Group} Group */

/** Pieces of a file that become one blob, which the browser may keep on disk. */
const PIECES = 16;

class Cancelled extends Error {}

/** @param {{engine: Engine} & import("../state/types.js").Page} page  @param {[string, (state: State, engine: Engine) => Offer[]][]} others  What other parts of the page offer, each list with its title. @param {import("./lazy_popover.js").Popover} popover @returns {import("./lazy_popover.js").Content} */
export function createExports({ engine, now }, others, { isOpen }) {
  const stretch = /** @type {HTMLSelectElement} */ (byId("export-stretch"));
  const list = byId("export-list");
  const status = byId("export-status");
  const cancel = byId("export-cancel");
  const bar = /** @type {HTMLProgressElement} */ (byId("export-progress"));
  let stopped = false;
  let busy = false;
  stretch.addEventListener("change", offer);
  cancel.addEventListener("click", () => {
    stopped = true;
  });

  function offer() {
    const state = now();
    const span = between(state);
    const { clock_hz = 1 } = state.result?.summary ?? {};
    const whole = state.result ? `the whole run, ${time(state.result.summary.end_s)}` : "the whole run";
    options(
      stretch,
      [
        ["whole", whole],
        ...(span
          ? [
              /** @type {[string, string]} */ ([
                "cursors",
                `between A and B, ${time((span.end - span.start) / clock_hz)}`,
              ]),
            ]
          : []),
      ],
      span ? stretch.value || "whole" : "whole",
    );
    if (!busy)
      say(
        status,
        state.result
          ? isStale(state)
            ? "The views show an earlier experiment than the form; files are of what the views show."
            : ""
          : "Nothing was run yet.",
      );
    const groups = [
      ...offers(state, engine, stretch.value === "cursors" ? span : null),
      ...others.map(([title, offered]) => ({ title, offers: offered(state, engine) })),
    ];
    fill(
      list,
      ...groups
        .filter(({ offers }) => offers.length > 0)
        .map(({ title, offers }) => {
          const group = element("div", { role: "group", "aria-label": title }, element("h3", {}, title));
          for (const each of offers) {
            const press = element("button", { type: "button", "data-file": each.name }, each.label);
            press.disabled = busy;
            press.addEventListener("click", () => run(each));
            group.append(press);
          }
          return group;
        }),
    );
  }

  /** @param {Offer} offered */
  async function run({ name, type, make }) {
    const begun = now().result?.summary;
    const show = (/** @type {boolean} */ on) => {
      busy = on;
      bar.hidden = cancel.hidden = !on;
      for (const press of list.querySelectorAll("button")) press.disabled = on;
    };
    stopped = false;
    bar.value = 0;
    say(status, `Making ${name}…`);
    show(true);
    try {
      const parts = await make((part) => {
        if (stopped) throw new Cancelled();
        if (now().result?.summary !== begun) throw new Error("the experiment was run anew meanwhile; export again");
        bar.value = part;
      });
      save(name, type, parts);
      const bytes = parts.reduce(
        (sum, part) =>
          sum + (typeof part === "string" ? part.length : part instanceof Blob ? part.size : part.byteLength),
        0,
      );
      say(status, `Saved ${name}, ${si(bytes, "B", 3)}.`);
    } catch (error) {
      const why = error instanceof Dropped ? "the engine was started again; export again" : message(error);
      say(status, error instanceof Cancelled ? "Left off: nothing was saved." : `No ${name}: ${why}`);
    }
    show(false);
    offerAgain();
  }

  /** Keeps the last word on a file while the list is made anew. */
  function offerAgain() {
    const said = status.textContent ?? "";
    if (isOpen()) offer();
    say(status, said);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (
      isOpen() &&
      !busy &&
      before &&
      (before.result !== state.result || before.cursors !== state.cursors || before.validation !== state.validation)
    )
      offer();
  }
  return { opened: offer, render };
}

/** @param {State} state @param {Engine} engine @param {Span | null} span  Cycles, both in it; null is the whole run. @returns {Group[]} */
function offers(state, engine, span) {
  const { result, validation, scenario } = state;
  const base = baseName(state);
  const settings = validation
    ? [
        {
          name: `${base}.json`,
          type: "application/json",
          label: "Scenario, JSON",
          make: async () => [validation.scenario, "\n"],
        },
      ]
    : [];
  const controller = selected(state);
  if (!result || !controller) return [{ title: "Experiment", offers: settings }];
  const { controllers, end_cycle } = result.summary;
  const part = controllers.length > 1 ? `-controller-${result.controller + 1}` : "";
  const cut = span ? `-${span.start}-${span.end}` : "";
  const { start, end } = span ?? { start: 0, end: end_cycle };
  /** @param {string} kind @param {string} suffix @param {string} type @param {string} label @returns {Offer} */
  const file = (kind, suffix, type, label) => ({
    name: `${base}${part}${cut}${suffix}`,
    type,
    label,
    make: (pace) => pieces(engine, kind, result.controller, start, end, pace),
  });
  /** @param {string} suffix @param {string} label @param {string} method @param {(answer: any, clockHz: number) => string} table @returns {Offer} */
  const table = (suffix, label, method, table) => ({
    name: `${base}${part}${suffix}`,
    type: "text/csv",
    label,
    make: async () => [table(await engine.ask(method), result.summary.clock_hz)],
  });
  const { source } = scenario;
  const segments = source?.segments || source?.motion?.engine === "segments";
  // Nothing was sent, and no segments run it.
  const isPanel = Boolean(source?.standalone);
  return [
    {
      title: "Signals",
      offers: [
        file("vcd", ".vcd", "text/plain", "VCD, for GTKWave, Surfer, PulseView"),
        file("edges", "-edges.csv", "text/csv", `CSV of edges, ${count(controller.records)} rows in the whole run`),
        file("trace", ".trace", "text/plain", "Trace, cycle and levels in hex"),
      ],
    },
    {
      title: "Tables, CSV",
      offers: [
        ...(isPanel
          ? []
          : [
              segments
                ? file("segments", "-segments.csv", "text/csv", "Segment lists")
                : file("ticks", "-ticks.csv", "text/csv", "Ticks, steps of each channel"),
            ]),
        table("-harmonics.csv", "Harmonics", "spectrum", harmonicsTable),
        ...(controller.violations === null
          ? []
          : [
              table("-margins.csv", "Driver timing: margins", "timing", marginsTable),
              table("-violations.csv", "Driver timing: violations", "timing", violationsTable),
            ]),
      ],
    },
    {
      title: "Experiment",
      offers: [
        ...settings,
        ...(isPanel
          ? []
          : [
              {
                name: `${base}-line.json`,
                type: "application/json",
                label: segments ? "Scenario of its segments, JSON" : "Line script of what was sent, JSON",
                make: async () => [await engine.ask("line_script"), "\n"],
              },
            ]),
      ],
    },
  ];
}

/** A file that the worker makes, in blobs. @param {Engine} engine @param {string} kind @param {number} controller @param {number} start @param {number} end @param {(part: number) => void} pace */
async function pieces(engine, kind, controller, start, end, pace) {
  /** @type {Blob[]} */
  const blobs = [];
  /** @type {BlobPart[]} */
  let gathered = [];
  /** @type {number | null} */
  let from = 0;
  while (from !== null) {
    const piece = await engine.ask("file_piece", kind, controller, start, end, from);
    if (!piece) throw new Error("there is no run to be saved");
    gathered.push(piece.bytes);
    if (gathered.length === PIECES || piece.next === null) {
      blobs.push(new Blob(gathered));
      gathered = [];
    }
    from = piece.next;
    pace((from ?? piece.rows) / Math.max(1, piece.rows));
  }
  return blobs;
}
