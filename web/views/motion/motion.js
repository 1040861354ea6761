/** The motion view: position, speed and acceleration, ideal and actual. */
import { byId, setOptions, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { short, si } from "../../state/number.js";
import { selected } from "../../state/queries.js";
import { shown } from "../../state/time_window.js";
import { drawCursors, hasOverlayChanged } from "../../time/cursors.js";
import { createHandles } from "../../time/handles.js";
import { drawOutlines } from "../../time/outlines.js";
import { cleared, draw, fit, GUTTER, MARGIN, watch } from "../../time/plot.js";
import { onTimeAxis } from "../../time/timeline.js";
import { createAxes } from "./axes.js";
import { unitOf, unitsOf } from "./axis_units.js";
import { chartOf, hasAcceleration, quantitiesOf, TIME_PX } from "./bands.js";
import { createCompare } from "./compare.js";
import { createCornerHandles } from "./corner_handles.js";
import { createReading } from "./reading.js";
import { requestColumns } from "./request_columns.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {ReturnType<typeof chartOf>} Drawn */

/** Minimum time between two updates of the charts while the visible time moves, in ms. */
const UPDATE_MS = 80;

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createMotion({ engine, dispatch, now }) {
  const stack = byId("charts");
  const overlay = /** @type {HTMLCanvasElement} */ (byId("charts-cursor"));
  const axisSelect = /** @type {HTMLSelectElement} */ (byId("motion-axis"));
  const unitSelect = /** @type {HTMLSelectElement} */ (byId("motion-unit"));
  /** The values between the cursors, loaded when both are first set. @type {ReturnType<typeof import("./between.js").createBetween> | null} */
  let between = null;
  const compare = createCompare({ engine, dispatch, now });
  const axes = createAxes({ dispatch, now });
  const fold = /** @type {HTMLDetailsElement} */ (byId("motion-data"));
  /** The table of the charts, loaded when it is first opened. @type {ReturnType<typeof import("./record.js").createRecord> | null} */
  let record = null;
  const reading = createReading({ engine, now });
  const handles = createHandles(byId("charts-handles"), () => plot, { dispatch, now });
  const corners = createCornerHandles(
    /** @type {HTMLCanvasElement} */ (byId("chart-speed")),
    () => unitOf(now()).scale,
    { dispatch, now },
    () => refresh(now()),
  );
  /** While a corner is dragged, the time axis stays. @param {State} state @returns {State} */
  const frozen = (state) => ({ ...state, window: corners.axes()?.window ?? state.window });
  /** @type {import("./bands.js").MotionData | null} */
  let data = null;
  /** @type {Drawn[]} */
  let drawn = [];
  let plot = { left: GUTTER, right: GUTTER + 1 };
  let isKeyboardUsed = false;

  axisSelect.addEventListener("change", () => dispatch({ type: "axis", axis: Number(axisSelect.value) }));
  unitSelect.addEventListener("change", () =>
    dispatch({ type: "unit", unit: /** @type {State["unit"]} */ (unitSelect.value) }),
  );
  stack.addEventListener(
    "keydown",
    () => {
      isKeyboardUsed = true;
    },
    { capture: true },
  );
  stack.addEventListener("pointerdown", () => {
    isKeyboardUsed = false;
  });
  fold.addEventListener("toggle", async () => {
    try {
      const { createRecord } = await import("./record.js");
      record ??= createRecord({ engine, now });
      record.render(now());
    } catch {
      setText(byId("record-page"), "The table could not be loaded. Check the network and open it again.");
    }
  });
  onTimeAxis(stack, () => plot, { dispatch, now });
  /** Time of the last request, and the timer of the next one. */
  let [requested, later] = [0, 0];
  watch(stack, () => refresh(now()));

  /** @param {State} current */
  async function refresh(current) {
    const state = frozen(current);
    requested = performance.now();
    plot = { left: GUTTER, right: Math.max(GUTTER + 1, stack.clientWidth - MARGIN) };
    if (!state.result || stack.clientWidth < 60) return;
    const wanted = Math.max(16, Math.round(plot.right - plot.left));
    const reply = await requestColumns(engine, state, shown(state), wanted).catch(unlessDropped);
    if (!reply) return;
    if (state.baseline && !reply.baseline) dispatch({ type: "baseline", baseline: null });
    data = reply;
    paint(now());
  }

  /** @param {State} current */
  function paint(current) {
    const state = frozen(current);
    if (!data || !state.result) return;
    const found = data;
    const quantities = quantitiesOf(state, found);
    stack.classList.toggle("two", quantities.length === 2);
    /** @type {HTMLElement} */ (byId("chart-acceleration").parentElement).hidden = !hasAcceleration(state, found);
    drawn = quantities.map((quantity) => chartOf(state, found, quantity));
    for (const [index, quantity] of quantities.entries()) {
      const canvas = /** @type {HTMLCanvasElement} */ (byId(`chart-${quantity}`));
      const { bands, others, caption, note, range, unit, chart } = drawn[index];
      setText(byId(`caption-${quantity}`), [`${caption}, ${unit}`, note].filter(Boolean).join(" · "));
      if (quantity === "speed") Object.assign(chart.y, corners.axes()?.range);
      const area = draw(canvas, { ...chart, series: chart.series.slice(others) });
      if (area) drawOutlines(canvas, area, { ...chart, series: chart.series.slice(0, others) });
      if (quantity === "speed") corners.render(state, area, chart.y);
      const text = bands.length === 0 ? "no data" : `from ${short(range.low)} to ${short(range.high)} ${unit}`;
      canvas.setAttribute("aria-label", `${caption} over time: ${text}`);
    }
    fit(overlay);
    paintCursor(state);
  }

  /** Draws the cursors on their own canvas, so that a moving pointer redraws nothing else. @param {State} state */
  function paintCursor(state) {
    const layer = cleared(overlay);
    if (!layer || !data || !state.result) return;
    drawCursors(layer.context, state, plot, layer.height - TIME_PX);
    handles.render(state);
    void reading.render(state);
    setText(byId("motion-sentence"), sentence(state));
  }

  /** The visible time and the values between the cursors as text. @param {State} state */
  function sentence(state) {
    const { start, end } = shown(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    const baseline = state.baseline ? ` Dashed: the baseline ${state.baseline.title}.` : "";
    return `Axis ${state.axis}, ${si(start / clock, "s")} to ${si(end / clock, "s")}.${baseline} ${between?.sentence() ?? ""}`.trim();
  }

  /** @param {State} state */
  async function showBetween({ cursors: { a, b } }) {
    if (!between && (a === null || b === null)) return;
    try {
      const { createBetween } = await import("./between.js");
      between ??= createBetween({ engine });
    } catch {
      byId("between").hidden = false;
      return setText(
        byId("between-span"),
        "This part of the page could not be loaded. Check the network and try again.",
      );
    }
    await between.render(now());
    setText(byId("motion-sentence"), sentence(now()));
  }

  /** Updates the charts after the visible time moved, but not in every frame, because the pulses need the time. */
  function follow() {
    const wait = requested + UPDATE_MS - performance.now();
    if (wait <= 0) return refresh(now());
    if (later === 0) {
      later = window.setTimeout(() => {
        later = 0;
        refresh(now());
      }, wait);
    }
    return undefined;
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (
      before?.result !== state.result ||
      before?.derived !== state.derived ||
      before?.axis !== state.axis ||
      before?.unit !== state.unit
    ) {
      const count = selected(state)?.channels ?? 1;
      /** @type {HTMLElement} */ (axisSelect.parentElement).hidden = count === 1;
      setOptions(
        axisSelect,
        Array.from({ length: count }, (_, i) => [String(i), String(i)]),
        String(state.axis),
      );
      setOptions(unitSelect, unitsOf(state), unitOf(state).name);
    }
    compare.render(state, before);
    axes.render(state, before);
    if (before?.drafts !== state.drafts) corners.render(state);
    const isOtherCurve =
      before?.axis !== state.axis ||
      before?.result !== state.result ||
      before?.baseline !== state.baseline ||
      before?.hiddenAxes !== state.hiddenAxes;
    const isMoved = isOtherCurve || before?.window !== state.window;
    if (before?.window !== state.window || isOtherCurve || before?.unit !== state.unit) record?.render(state);
    if (before && isKeyboardUsed && before.cursors !== state.cursors)
      reading.speak(state, before.cursors.b === state.cursors.b ? "a" : "b");
    if (before?.cursors !== state.cursors || isOtherCurve || before?.unit !== state.unit)
      void showBetween(state).catch(unlessDropped);
    if (before && !isOtherCurve && before.window !== state.window && before.difference === state.difference)
      return follow();
    if (isMoved || before?.difference !== state.difference || (state.difference && before?.unit !== state.unit))
      return refresh(state);
    // Another unit may have other axes.
    if (before?.unit !== state.unit) return refresh(state);
    if (hasOverlayChanged(before, state)) paintCursor(frozen(state));
    return undefined;
  }
  return { render };
}
