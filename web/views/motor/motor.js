/** The motor view: curves over time, a summary and numbers. */
import { byId, element, fill, setOptions, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { short, si } from "../../state/number.js";
import { selected } from "../../state/queries.js";
import { readingCycle, shown } from "../../state/time_window.js";
import { drawCursors, hasOverlayChanged } from "../../time/cursors.js";
import { createHandles } from "../../time/handles.js";
import { cleared, draw, fit, GUTTER, MARGIN, watch } from "../../time/plot.js";
import { onTimeAxis } from "../../time/timeline.js";
import { swatch } from "../lines.js";
import { createChoice } from "./choice.js";
import { createSummary } from "./motor_summary.js";
import { showNumbers } from "./numbers.js";
import { channelOf, chartOf, marksOf, QUANTITIES, visibleQuantities } from "./quantities.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./numbers.js").Report} Report */

/** Delay after a cursor moved before its values are spoken, in ms. */
const SPEAK_MS = 500;
/** Height of the time labels below the last chart, in CSS pixels. */
const TIME_PX = 20;

/** @param {import("./pane.js").Page} page */
export function createMotor({ engine, dispatch, now }) {
  const channels = /** @type {HTMLSelectElement} */ (byId("motor-channel"));
  const stack = byId("motor-charts");
  const overlay = element("canvas", { class: "overlay", "aria-hidden": "true" });
  const strip = element("div", { class: "handles" });
  const note = byId("motor-note");
  const spoken = element("p", { class: "unseen", "aria-live": "polite" });
  byId("motor-body").append(spoken);
  let speaking = 0;
  const summary = createSummary({ engine, now, node: byId("motor-verdict") });
  const choice = createChoice({ engine, dispatch, now }, /** @type {HTMLDetailsElement} */ (byId("motor-choice")));
  let plot = { left: GUTTER, right: GUTTER + 1 };
  const charts = QUANTITIES.map((quantity) => {
    const canvas = element("canvas", { role: "img", "aria-label": `${quantity.title} over time` });
    const reading = element("output", { class: "reading", "aria-live": "off" });
    const keys = quantity.lines.map(({ label, ink, dash }) =>
      element("span", {}, swatch(ink, dash !== undefined), ` ${label}`),
    );
    const caption = element(
      "div",
      { class: "caption" },
      element("span", {}, `${quantity.title.toLowerCase()}, ${quantity.unit}`),
      ...keys,
      reading,
    );
    const root = element("div", { class: "chart" }, caption, canvas);
    const { title, short: label = title } = quantity;
    const press = element("button", { type: "button", "aria-pressed": "false", "aria-label": title, title }, label);
    press.addEventListener("click", () => {
      const names = visibleQuantities(now()).map(({ name }) => name);
      const others = names.filter((name) => name !== quantity.name);
      if (others.length === names.length) dispatch({ type: "quantities", names: [...names, quantity.name] });
      else if (others.length > 0) dispatch({ type: "quantities", names: others });
    });
    return { quantity, canvas, reading, root, press };
  });
  fill(byId("motor-quantities"), ...charts.map(({ press }) => press));
  fill(stack, ...charts.map(({ root }) => root), overlay, strip);
  const handles = createHandles(strip, () => plot, { dispatch, now });
  onTimeAxis(stack, () => plot, { dispatch, now });
  channels.addEventListener("change", () => dispatch({ type: "axis", axis: Number(channels.value) }));
  watch(stack, () => void loadCurves(now()));

  /** @type {Report | null} */
  let report = null;
  /** @type {import("./quantities.js").Curves | null} */
  let curves = null;
  /** The window of the curves. */
  let curveWindow = { start: 0, end: 1 };
  /** The result of report and curves. @type {State["result"]} */
  let resultOfReport = null;
  arrange();
  byId("motor-limits").addEventListener("click", () => {
    dispatch({ type: "study", study: "motor" });
    dispatch({ type: "view", view: "study" });
  });

  function shownCharts() {
    const visible = visibleQuantities(now());
    return charts.filter(({ quantity }) => visible.includes(quantity));
  }

  /** Distributes the height among the visible charts; the last one has the time labels. */
  function arrange() {
    const visibleCharts = shownCharts();
    for (const each of charts) {
      const { root, press } = each;
      root.hidden = !visibleCharts.includes(each);
      press.setAttribute("aria-pressed", String(!root.hidden));
    }
    // --chart-px is the minimum height of a chart; with more charts than fit the view scrolls.
    stack.classList.toggle("many", visibleCharts.length > 4);
    const rows = visibleCharts.length - 1;
    stack.style.gridTemplateRows = `${"minmax(var(--chart-px), 1fr) ".repeat(rows)}calc((100% - ${TIME_PX}px) / ${rows + 1} + ${TIME_PX}px)`;
    stack.style.minHeight = `calc(${rows + 1} * var(--chart-px) + ${2 * TIME_PX}px)`;
  }

  /** @param {State} state */
  async function loadReport(state) {
    const { result } = state;
    const reply = /** @type {Report | null | undefined} */ (await engine.latest("plant", "plant").catch(unlessDropped));
    if (reply === undefined || now().result !== result) return;
    [resultOfReport, report] = [result, reply];
    const hasReport = report !== null;
    for (const part of ["motor-body", "motor-quantities", "motor-limits"]) byId(part).hidden = !hasReport;
    setText(note, "");
    choice.show(state, hasReport);
    summary.show(state, report, channelOf(state));
    if (!report) return;
    showNumbers(byId("motor-numbers"), report, result?.summary.clock_hz ?? 1);
    await loadCurves(state);
  }

  /** @param {State} state */
  async function loadCurves(state) {
    plot = { left: GUTTER, right: Math.max(GUTTER + 1, stack.clientWidth - MARGIN) };
    if (!report || resultOfReport !== state.result || stack.clientWidth < 60) return;
    const { start, end } = shown(state);
    const columns = Math.max(16, Math.round(plot.right - plot.left));
    const channel = channelOf(state);
    const reply = await engine
      .latest("plant curves", "plant_curves", channel, start, end, columns)
      .catch(unlessDropped);
    if (!reply || resultOfReport !== now().result || channel !== channelOf(now())) return;
    [curves, curveWindow] = [reply, { start, end }];
    paint();
  }

  function paint() {
    const state = now();
    if (!curves || !report || !state.result) return;
    const clock = state.result.summary.clock_hz;
    const { start, end } = curveWindow;
    const marks = marksOf(report, channelOf(state), curveWindow, clock);
    const time = { from: start / clock, to: end / clock, marks };
    const visibleCharts = shownCharts();
    for (const { quantity, canvas } of visibleCharts) {
      const last = quantity === visibleCharts[visibleCharts.length - 1].quantity;
      const { range, chart } = chartOf(quantity, curves, time, last);
      draw(canvas, chart);
      canvas.setAttribute(
        "aria-label",
        `${quantity.title} over time: from ${short(range.low)} to ${short(range.high)} ${quantity.unit}`,
      );
    }
    fit(overlay);
    paintCursor(state);
  }

  /** @param {State} state */
  function paintCursor(state) {
    const layer = cleared(overlay);
    if (!layer || !report) return;
    drawCursors(layer.context, state, plot, layer.height - TIME_PX);
    handles.render(state);
    void showReadings(state);
  }

  /** Shows the exact values at the pointer or a cursor. @param {State} state */
  async function showReadings(state) {
    const { a, b } = state.cursors;
    const cycle = readingCycle(state);
    const values =
      cycle === null
        ? null
        : await engine.latest("plant reading", "plant_at", channelOf(state), cycle).catch(unlessDropped);
    if (values === undefined) return;
    const at = cycle === null ? "" : `${cycle === a ? "A " : cycle === b ? "B " : ""}${cycleTime(cycle, state)}: `;
    const valueText = (/** @type {{of: string}} */ { of }) => short(withoutNoise(values?.[of] ?? Number.NaN), 6);
    for (const { quantity, reading } of charts)
      setText(reading, values ? `${at}${quantity.lines.map(valueText).join(" · ")}` : "");
    speak(values && state.hover === null ? `${at}${sentence(valueText)}` : "");
  }

  /** The visible values as text. @param {(line: {of: string}) => string} valueText */
  function sentence(valueText) {
    return visibleQuantities(now())
      .map(
        ({ title, unit, lines }) =>
          `${title} ${lines.map((each) => `${each.label} ${valueText(each)}`).join(", ")} ${unit}`,
      )
      .join("; ");
  }

  /** Speaks a text some time after the last call. @param {string} text */
  function speak(text) {
    clearTimeout(speaking);
    if (text) speaking = window.setTimeout(() => setText(spoken, text), SPEAK_MS);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const count = selected(state)?.channels ?? 1;
    /** @type {HTMLElement} */ (channels.parentElement).hidden = count < 2;
    setOptions(
      channels,
      Array.from({ length: count }, (_, i) => [String(i), String(i)]),
      String(channelOf(state)),
    );
    if (before?.quantities !== state.quantities) {
      arrange();
      paint();
    }
    if (before?.scenario !== state.scenario) choice.show(state, report !== null);
    if (resultOfReport !== state.result || before?.result !== state.result) return loadReport(state);
    if (before?.axis !== state.axis) summary.show(state, report, channelOf(state));
    if (before?.axis !== state.axis || before?.window !== state.window) return loadCurves(state);
    if (hasOverlayChanged(before, state)) paintCursor(state);
    return undefined;
  }
  return { render };
}

/** Rounds values below the printed digits to 0. @param {number} value */
function withoutNoise(value) {
  return Math.abs(value) < 1e-12 ? 0 : value;
}

/** @param {number} cycle @param {State} state */
function cycleTime(cycle, state) {
  return si(cycle / (state.result?.summary.clock_hz ?? 1), "s", 6);
}
