/**
 * The tab Sine of the study: what each largest deviation d1 makes of a sine in segments (the document's figure 4), the best
 * d1 of a range, and the best vertices for a number of segments. What a tab is, says study.js.
 */
import { button, element, fill, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { listen } from "../../shell/commands.js";
import { counted, short } from "../../state/number.js";
import { get } from "../../state/paths.js";
import { cleared, color, draw, fit, watch } from "../../time/plot.js";
import { choice, createJob, field, table } from "./parts.js";
import { createSegments } from "./segments.js";
import { selectedAxis } from "./selected_axis.js";
import { createVertices } from "./vertices.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {"position" | "speed" | "acceleration" | "filtered"} Quantity */
/** @typedef {{d1: Float64Array, segments: Float64Array, position: Float64Array, speed: Float64Array, acceleration: Float64Array, filtered: Float64Array, euclidean: Float64Array}} Rows */
/** @typedef {{[name in keyof Rows]: number}} Row */

/** Points of one piece of the sweep: a few ms. */
const PIECE = 10;
/** Pieces of the range in which the best d1 of each number of segments is looked for. */
const STRETCHES = 16;
const GUTTER = 58;
/** A distortion has harmonics 2 and 3 at least. */
const MIN_ORDER = 3;
/** The most that the scenario takes. */
const MAX_ORDER = 1000;
const NAMES = /** @type {(keyof Rows)[]} */ ([
  "d1",
  "segments",
  "position",
  "speed",
  "acceleration",
  "filtered",
  "euclidean",
]);

/** A d1 as the scenario takes it: with few digits, and not below where its polyline begins. @param {number} d1 */
const rounded = (d1) => Math.ceil(d1 * 1e8 - 1e-4) / 1e8;
/** @param {number} ratio */
const percent = (ratio) => (Number.isFinite(ratio) ? `${short(100 * ratio, 4)} %` : "–");

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createSine({ engine, samples, dispatch, now, panel }) {
  const from = field("d1 from", "", 0.002, { least: 1e-5, most: 1 }, refresh);
  const to = field("to", "", 0.06, { least: 1e-5, most: 1 }, refresh);
  const points = field("points", "", 500, { least: 2, most: 20000, integer: true }, refresh);
  // The one setting of the experiment: what is read here is what the spectrum tells.
  const order = field("harmonics to", "", MIN_ORDER, { least: MIN_ORDER, most: MAX_ORDER, integer: true }, () =>
    dispatch({ type: "edit", path: "analysis.order", value: order.value() }),
  );
  const quantity = choice(
    "THD of",
    { position: "position", speed: "speed", acceleration: "acceleration", filtered: "acceleration, filtered" },
    paint,
  );
  const job = createJob("Sweep", () => (rows ? " The charts show the sweep before." : ""));
  const thdCanvas = element("canvas", { role: "img", "aria-label": "THD against d1" });
  const distanceCanvas = element("canvas", { role: "img", "aria-label": "Euclidean distance against d1" });
  const overlay = element("canvas", { class: "overlay", "aria-hidden": "true" });
  const noThd = element("p", { class: "study-note no-chart" });
  noThd.hidden = true;
  const thdCaption = element("div", { class: "caption" });
  const distanceCaption = element("div", { class: "caption" }, element("span", {}, "Euclidean distance Ev against d1"));
  const charts = element(
    "div",
    {
      class: "charts study-charts",
      id: "sine-charts",
      tabindex: "0",
      role: "slider",
      "aria-label": "d1",
      "aria-valuemin": "0",
      "aria-valuemax": "0",
      "aria-valuenow": "0",
    },
    element("div", { class: "chart" }, thdCaption, thdCanvas, noThd),
    element("div", { class: "chart" }, distanceCaption, distanceCanvas),
    overlay,
  );
  const list = table("What a d1 gives", [
    "of",
    "#d1",
    "#segments",
    "#THD position",
    "~#speed",
    "~#acceleration",
    "~#filtered",
    "#Ev",
    "",
  ]);
  const note = element("p", { class: "study-note", id: "sine-note", "aria-live": "polite", tabindex: "-1" });
  const bestOf = table("Best d1 of each number of segments", ["segments", "#best d1", "#THD position", "~#Ev", ""]);
  const vertices = createVertices({ engine, order: order.value, take: putMove });
  const quarter = createSegments({ engine });
  fill(
    panel,
    element("div", { class: "study-bar" }, from.root, to.root, points.root, order.root, quantity.root, job.root),
    element(
      "div",
      { class: "study-split" },
      element("div", { class: "study-column" }, charts, list.root, note),
      element(
        "div",
        { class: "study-column study-side" },
        element("h3", {}, "Best d1 of each number of segments, by position"),
        bestOf.root,
        ...vertices.parts,
        quarter.root,
      ),
    ),
  );

  /** @type {Rows | null} What the charts show, as far as it is made. */
  let rows = null;
  /** @type {Row | null} */
  let least = null;
  /** Of the scenario's d1. @type {Row | null} */
  let own = null;
  let ownKey = "";
  /** The row that is pointed at. @type {number | null} */
  let at = null;
  /** Where the charts are on their canvases; the one of the THD may be without. @type {import("../../state/types.js").Plot | null} */
  let plot = null;
  /** The highest harmonic of the rows. */
  let sweptOrder = 0;
  /** What the note tells of the scenario, which it does only as long as that is so. @type {{path: string, json: string} | null} */
  let claim = null;
  let swept = false;
  let shownOrder = 0;
  /** Bandwidth of the sensor that feels the acceleration, in harmonics. @type {number | undefined} */
  let sensor;

  watch(charts, paint);
  charts.addEventListener("pointermove", (event) => point(rowAt(event)));
  charts.addEventListener("click", (event) => {
    point(rowAt(event));
    take();
  });
  const move = (/** @type {number} */ by) =>
    point(Math.min((rows?.d1.length ?? 1) - 1, Math.max(0, (at ?? (by > 0 ? -1 : 1)) + by)));
  listen(charts, "Sine: figure 4", [
    { keys: ["ArrowRight", "ArrowUp"], text: "the next d1", run: () => move(1) },
    { keys: ["ArrowLeft", "ArrowDown"], text: "the d1 before", run: () => move(-1) },
    { keys: ["PageUp"], text: "twenty further", run: () => move(20) },
    { keys: ["PageDown"], text: "twenty back", run: () => move(-20) },
    { keys: ["Home"], text: "the least d1", run: () => point(0) },
    { keys: ["End"], text: "the greatest d1", run: () => move(1e9) },
    { keys: ["Enter", "Space"], text: "take this d1 into the scenario", run: take },
  ]);

  /** @param {PointerEvent | MouseEvent} event */
  function rowAt({ clientX }) {
    if (!plot || !rows) return null;
    const part = (clientX - charts.getBoundingClientRect().left - plot.left) / (plot.right - plot.left);
    return part < -0.02 || part > 1.02
      ? at
      : Math.min(rows.d1.length - 1, Math.max(0, Math.round(part * (rows.d1.length - 1))));
  }

  /** @param {number | null} index */
  function point(index) {
    if (index === at) return;
    at = index;
    mark();
  }

  function take() {
    const row = at === null ? null : rowOf(rows, at);
    if (row) put(row.d1);
  }

  /** The sine of the selected axis. @param {State} state */
  function sineOf(state) {
    const of = selectedAxis(state);
    if (!of || typeof of === "string") return { of: null, move: -1 };
    return { of, move: of.moves.findIndex((/** @type {any} */ each) => each.sine_segments) };
  }

  /** Puts a d1 into the scenario. @param {number} d1 */
  function put(d1) {
    const { of, move } = sineOf(now());
    claim = null;
    if (!of)
      return say(
        note,
        selectedAxis(now())
          ? "The scenario has no axis that could take it."
          : "Not while the form has a problem, or is being looked at.",
      );
    if (move < 0) return offer(d1);
    const path = `${of.path}.moves[${move}].sine_segments.max_deviation`;
    edit(path, rounded(d1));
    say(note, `Move ${move + 1} of axis ${of.axis} has d1 = ${rounded(d1)} now; undo brings the one before back.`);
    return undefined;
  }

  /** @param {string} path @param {any} value */
  function edit(path, value) {
    claim = { path, json: JSON.stringify(value) };
    dispatch({ type: "edit", path, value });
  }

  /** Puts a move in the place of the axis' sine, or behind its moves. @param {(sine: any) => object | string} made  Of the sine; or why not. */
  function putMove(made) {
    const { of, move } = sineOf(now());
    claim = null;
    if (!of) return say(note, "Not while the form has a problem, or is being looked at.");
    const value = made((of.moves[move] ?? samples.moves).sine_segments);
    if (typeof value === "string") return say(note, value);
    if (move < 0) {
      edit(`${of.path}.moves`, [...of.moves, value]);
      return say(note, `Axis ${of.axis} ends with a curve through these vertices now; undo takes it away.`);
    }
    edit(`${of.path}.moves[${move}]`, value);
    return say(note, `Move ${move + 1} of axis ${of.axis} goes through these vertices now; undo brings the sine back.`);
  }

  /** @param {Row} row @param {string} name */
  const use = (row, name) => button("Use", `Use: ${name}`, () => put(row.d1));

  /** Where there is no sine. @param {number} d1 */
  function offer(d1) {
    const press = element("button", { type: "button" }, `Add one with d1 = ${rounded(d1)}`);
    press.addEventListener("click", () => {
      // What the axis is by now.
      const { of, move } = sineOf(now());
      note.focus({ preventScroll: true });
      if (!of || move >= 0) return put(d1);
      edit(`${of.path}.moves`, [
        ...of.moves,
        { sine_segments: { ...samples.moves.sine_segments, max_deviation: rounded(d1) } },
      ]);
      return say(note, `Axis ${of.axis} ends with a sine in segments now; undo takes it away.`);
    });
    fill(note, `Axis ${sineOf(now()).of?.axis} has no sine in segments that could take it. `, press);
  }

  /** Sweeps the range, and looks for the best of it. */
  function refresh() {
    const [low, high, number, highest] = [from, to, points, order].map((each) => each.value());
    swept = true;
    to.fail(low >= high ? `Give more than ${low}, where the range begins.` : "");
    if (low >= high) return undefined;
    job.run(
      async (signal, tell) => {
        const pieces = Array.from({ length: Math.ceil(number / PIECE) }, (_, index) => [
          low,
          high,
          number,
          highest,
          sensor,
          PIECE * index,
          PIECE * (index + 1),
        ]);
        // The smaller d1, the more polylines are beside it.
        const edge = (/** @type {number} */ index) =>
          index === STRETCHES ? high : low * (high / low) ** (index / STRETCHES);
        const stretches = Array.from({ length: STRETCHES }, (_, index) => [
          edge(index),
          edge(index + 1),
          highest,
          sensor,
        ]);
        let done = 0;
        const all = pieces.length + STRETCHES;
        const progress = () =>
          tell(
            ++done / all,
            done < pieces.length ? `${Math.min(number, done * PIECE)} of ${number} points` : "the best d1 of the range",
          );
        tell(0, `0 of ${number} points`);
        // The rows before stay until these are there.
        const answers = joined(await engine.distribute("sine_rows", pieces, signal, progress));
        [rows, at, least, sweptOrder] = [answers, null, null, highest];
        paint();
        const found = await engine.distribute("sine_best", stretches, signal, progress);
        return joined(found);
      },
      (found) => {
        /** @type {Map<number, Row>} */
        const bests = new Map();
        for (let index = 0; index < found.d1.length; index++) {
          const row = /** @type {Row} */ (rowOf(found, index));
          if (!(row.position >= (bests.get(row.segments)?.position ?? Infinity))) bests.set(row.segments, row);
        }
        const sorted = [...bests.values()].sort((one, other) => one.segments - other.segments);
        bestOf.show(
          sorted.map((row) => [
            String(row.segments),
            short(row.d1, 6),
            percent(row.position),
            short(row.euclidean, 4),
            use(row, `${counted(row.segments, "segment")}, the best d1`),
          ]),
        );
        least = sorted.reduce((best, row) => (row.position < best.position ? row : best), sorted[0]) ?? null;
        paint();
      },
    );
    return undefined;
  }

  function paint() {
    const chosen = /** @type {Quantity} */ (quantity.value());
    const what =
      chosen !== "filtered"
        ? chosen
        : sensor === undefined
          ? "acceleration, filtered"
          : `the acceleration that a sensor of ${short(sensor, 4)} harmonics feels`;
    fill(
      thdCaption,
      element("span", {}, `THD of ${what}, against d1, harmonics 2 to ${sweptOrder || order.value()}, %`),
    );
    // Without a sensor there is nothing that it feels.
    const none = rows !== null && !rows[chosen].some(Number.isFinite);
    [thdCanvas.hidden, noThd.hidden] = [none, !none];
    say(
      noThd,
      !none
        ? ""
        : sensor === undefined
          ? "What a sensor feels: give its bandwidth in the form, under Spectrum, and the axis a sine in segments, which has the period."
          : "The sweep with the sensor is not made yet.",
    );
    if (rows && rows.d1.length > 1) {
      const { d1 } = rows;
      const x = { min: d1[0], max: d1[d1.length - 1], unit: "", prefix: false, label_px: 20 };
      const line = (
        /** @type {HTMLCanvasElement} */ canvas,
        /** @type {Float64Array} */ y,
        /** @type {string} */ ink,
      ) =>
        draw(canvas, {
          x,
          y: {
            min: 0,
            max: 1.05 * Math.max(1e-9, ...y.filter(Number.isFinite)),
            unit: "",
            prefix: false,
            label_px: GUTTER,
          },
          series: Number.isFinite(y[0])
            ? [{ color: color(ink), opacity: 1, width: 1.5, x: d1, shape: { line: { y } } }]
            : [],
        });
      if (!none)
        line(
          thdCanvas,
          rows[chosen].map((ratio) => 100 * ratio),
          "--ideal",
        );
      plot = line(distanceCanvas, rows.euclidean, "--actual");
      fit(overlay);
    }
    mark();
  }

  /** The rows below, and where they are in the charts. */
  function mark() {
    const pointed = at === null ? null : rowOf(rows, at);
    charts.setAttribute("aria-valuemax", String((rows?.d1.length ?? 1) - 1));
    charts.setAttribute("aria-valuenow", String(at ?? 0));
    charts.setAttribute(
      "aria-valuetext",
      pointed
        ? `d1 ${short(pointed.d1)}, ${pointed.segments} segments, THD of ${quantity.value()} ${percent(pointed[/** @type {Quantity} */ (quantity.value())])}, Ev ${short(pointed.euclidean)}; Enter takes it`
        : "no d1 chosen",
    );
    const cells = (
      /** @type {string} */ name,
      /** @type {Row | null} */ row,
      /** @type {string} */ none,
      usable = true,
    ) => {
      return [
        name,
        ...(row
          ? [
              short(row.d1, 6),
              String(row.segments),
              percent(row.position),
              percent(row.speed),
              percent(row.acceleration),
              percent(row.filtered),
              short(row.euclidean, 4),
            ]
          : [none, "", "", "", "", "", ""]),
        usable && row ? use(row, name) : "",
      ];
    };
    list.root.classList.toggle("unfelt", sensor === undefined);
    list.show([
      cells("pointed at", pointed, "–"),
      cells("the scenario", own, "none", false),
      cells(`best by position${least && rows && atEnd(least.d1, rows.d1) ? ": the range's end" : ""}`, least, "–"),
    ]);
    const layer = cleared(overlay);
    if (!layer || !plot || !rows) return;
    const { left, right, top, bottom } = plot;
    const [low, high] = [rows.d1[0], rows.d1[rows.d1.length - 1]];
    const { context } = layer;
    /** @type {[Row | null, string, number[], string][]} */
    const lines = [
      [own, "--ink", [5, 4], "now"],
      [least, "--enable", [2, 3], "best by position"],
      [pointed, "--axis", [], ""],
    ];
    context.font = "11px system-ui, sans-serif";
    for (const [row, ink, dash, name] of lines) {
      if (!row || row.d1 < low || row.d1 > high) continue;
      const x = Math.round(left + ((row.d1 - low) / (high - low)) * (right - left)) + 0.5;
      context.strokeStyle = context.fillStyle = color(ink);
      context.setLineDash(dash);
      for (const canvas of [thdCanvas, distanceCanvas].filter(({ hidden }) => !hidden)) {
        const down = canvas.offsetTop + (canvas.parentElement?.offsetTop ?? 0);
        context.beginPath();
        context.moveTo(x, down + top);
        context.lineTo(x, down + bottom);
        context.stroke();
      }
      if (name)
        context.fillText(
          name,
          x + 4,
          (thdCanvas.hidden
            ? distanceCanvas.offsetTop + (distanceCanvas.parentElement?.offsetTop ?? 0)
            : thdCanvas.offsetTop) +
            top +
            (name === "now" ? 11 : 24),
        );
    }
    context.setLineDash([]);
  }

  /** What the scenario's own d1 gives. @param {State} state */
  async function current(state) {
    const { of, move } = sineOf(state);
    if (!of) return;
    quarter.show(move < 0 ? null : of);
    const d1 = of.moves[move]?.sine_segments.max_deviation ?? null;
    const next = `${d1} ${order.value()} ${sensor}`;
    if (next === ownKey) return;
    ownKey = next;
    const found =
      d1 === null
        ? null
        : rowOf(
            await engine.consider("sine row", "sine_rows", d1, d1, 1, order.value(), sensor, 0, 1).catch(unlessDropped),
            0,
          );
    if (next !== ownKey) return;
    own = found;
    mark();
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const { of, move } = sineOf(state);
    const { analysis } = state.scenario;
    const wanted =
      of && move >= 0 && analysis?.sensor_hz ? analysis.sensor_hz * of.moves[move].sine_segments.period_s : undefined;
    const highest = Math.max(MIN_ORDER, Number(analysis?.order) || 0);
    const other = of !== null && wanted !== sensor;
    if (other) sensor = wanted;
    // All that is shown is to one order.
    if (highest !== shownOrder) {
      shownOrder = highest;
      order.set(highest);
      swept = false;
    }
    // An undo takes away what the note tells of.
    if (claim && JSON.stringify(get(state.scenario, claim.path)) !== claim.json) {
      claim = null;
      say(note, "");
    }
    if (!swept) vertices.find();
    if (!swept || other) refresh();
    if (before?.view !== state.view || before?.study !== state.study) paint();
    return current(state);
  }
  return { render };
}

/** @param {Rows | null | undefined} rows @param {number} index @returns {Row | null} */
function rowOf(rows, index) {
  return rows && index < rows.d1.length
    ? /** @type {any} */ (Object.fromEntries(NAMES.map((name) => [name, rows[name][index]])))
    : null;
}

/** Whether a d1 is the first or the last of the range, beyond which there may be better ones. @param {number} d1 @param {Float64Array} range */
function atEnd(d1, range) {
  return [range[0], range[range.length - 1]].some((end) => Math.abs(d1 - end) <= 1e-6 * end);
}

/** @param {Rows[]} pieces @returns {Rows} */
function joined(pieces) {
  return /** @type {any} */ (
    Object.fromEntries(NAMES.map((name) => [name, Float64Array.from(pieces.flatMap((piece) => [...piece[name]]))]))
  );
}
