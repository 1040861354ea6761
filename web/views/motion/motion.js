/** The motion view: position, speed and acceleration over one time axis, the ideal curve over what the pulses make. */
import { byId, options, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, short, si, time } from "../../state/number.js";
import { selected, shown } from "../../state/state.js";
import { drawCursors, overlaid } from "../../time/cursors.js";
import { cleared, draw, fit, GUTTER, MARGIN, watch } from "../../time/plot.js";
import { gestures } from "../../time/timeline.js";
import { ask } from "./ask.js";
import { chartOf, columnAt, QUANTITIES, TIME_PX, unitFor, unitOf, unitsOf, withoutAcceleration } from "./bands.js";
import { createBetween } from "./between.js";
import { createCompare } from "./compare.js";
import { createRecord } from "./record.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {ReturnType<typeof chartOf>} Drawn */

/** Rest after a cursor moved by keys before its values are spoken, in ms. */
const SPEAK_MS = 500;

/** While the shown time moves, the charts follow at most so often, in ms. */
const FOLLOW_MS = 80;

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createMotion({ engine, dispatch, now }) {
  const stack = byId("charts");
  const overlay = /** @type {HTMLCanvasElement} */ (byId("charts-cursor"));
  const axisSelect = /** @type {HTMLSelectElement} */ (byId("motion-axis"));
  const unitSelect = /** @type {HTMLSelectElement} */ (byId("motion-unit"));
  const between = createBetween({ engine });
  const compare = createCompare({ engine, dispatch, now });
  const record = createRecord({ engine, now });
  /** @type {import("./bands.js").Seen | null} */
  let seen = null;
  /** @type {Drawn[]} */
  let drawn = [];
  let plot = { left: GUTTER, right: GUTTER + 1 };
  let byKeys = false;
  let speaking = 0;

  axisSelect.addEventListener("change", () => dispatch({ type: "axis", axis: Number(axisSelect.value) }));
  unitSelect.addEventListener("change", () =>
    dispatch({ type: "unit", unit: /** @type {State["unit"]} */ (unitSelect.value) }),
  );
  stack.addEventListener(
    "keydown",
    () => {
      byKeys = true;
    },
    { capture: true },
  );
  stack.addEventListener("pointerdown", () => {
    byKeys = false;
  });
  gestures(stack, () => plot, { dispatch, now });
  /** When the charts were asked for last, and the timer that will ask again. */
  let [asked, later] = [0, 0];
  watch(stack, () => refresh(now()));

  /** @param {State} state */
  async function refresh(state) {
    asked = performance.now();
    plot = { left: GUTTER, right: Math.max(GUTTER + 1, stack.clientWidth - MARGIN) };
    if (!state.result || stack.clientWidth < 60) return;
    const wanted = Math.max(16, Math.round(plot.right - plot.left));
    const answer = await ask(engine, state, shown(state), wanted).catch(unlessDropped);
    if (!answer) return;
    if (state.baseline && !answer.baseline) dispatch({ type: "baseline", baseline: null });
    seen = answer;
    paint(now());
  }

  /** @param {State} state */
  function paint(state) {
    if (!seen || !state.result) return;
    drawn = QUANTITIES.map((quantity) => chartOf(state, /** @type {import("./bands.js").Seen} */ (seen), quantity));
    for (const [index, quantity] of QUANTITIES.entries()) {
      const canvas = /** @type {HTMLCanvasElement} */ (byId(`chart-${quantity}`));
      const { bands, caption, range, unit, chart } = drawn[index];
      say(byId(`caption-${quantity}`), `${caption}, ${unit}`);
      draw(canvas, chart);
      const text = bands.length === 0 ? "nothing to show" : `from ${short(range.low)} to ${short(range.high)} ${unit}`;
      canvas.setAttribute("aria-label", `${caption} over time: ${text}`);
    }
    const note = withoutAcceleration(seen.columns);
    byId("no-acceleration").hidden = note === "";
    say(byId("no-acceleration"), note);
    fit(overlay);
    paintCursor(state);
  }

  /** The cursors, on a canvas of their own: a moving pointer redraws nothing else. @param {State} state */
  function paintCursor(state) {
    const layer = cleared(overlay);
    if (!layer || !seen || !state.result) return;
    drawCursors(layer.context, state, plot, layer.height - TIME_PX);
    const values = read(state, [state.hover, state.cursors.a]);
    say(byId("motion-time"), values ? values.at : "");
    for (const [index, quantity] of QUANTITIES.entries()) say(byId(`read-${quantity}`), values?.texts[index] ?? "");
    say(byId("motion-sentence"), sentence(state));
  }

  /** Values at the first of these cycles that is on show. @param {State} state @param {(number | null)[]} cycles */
  function read(state, cycles) {
    const { start, end } = shown(state);
    const cycle = cycles.find((at) => at !== null && at >= start && at <= end) ?? null;
    if (!seen || cycle === null) return null;
    const clock = state.result?.summary.clock_hz ?? 1;
    const at = columnAt(seen.columns, cycle / clock);
    return {
      at: `${time(cycle / clock)} · cycle ${count(cycle)}`,
      texts: drawn.map(({ bands, unit }) => {
        const values = bands
          .map(({ name, min, max }) => {
            const [low, high] = [min[at], max[at]];
            if (!Number.isFinite(low)) return "";
            const same = Math.abs(high - low) <= 1e-6 * Math.max(1e-9, Math.abs(high));
            return `${name} ${same ? short(low) : `${short(low)} to ${short(high)}`}`;
          })
          .filter(Boolean);
        return values.length ? `${values.join("  ·  ")} ${unit}` : "";
      }),
    };
  }

  /** What the charts show now. @param {State} state */
  function sentence(state) {
    const { start, end } = shown(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    const baseline = state.baseline ? ` Beside it, dashed, the baseline ${state.baseline.title}.` : "";
    return `Axis ${state.axis}, ${si(start / clock, "s")} to ${si(end / clock, "s")}.${baseline} ${between.sentence()}`.trim();
  }

  /** Says a cursor's values once it stands, where keys moved it. @param {State} state @param {"a" | "b"} which */
  function speak(state, which) {
    clearTimeout(speaking);
    const cycle = state.cursors[which];
    speaking = window.setTimeout(async () => {
      if (cycle === null) return say(byId("motion-spoken"), `Cursor ${which.toUpperCase()} is removed.`);
      /** @type {import("../../state/types.js").Between | null} */
      const answer = (await engine.latest("spoken", "between", state.axis, cycle, cycle).catch(unlessDropped)) ?? null;
      if (!answer) return;
      const { scale } = unitOf(state);
      const texts = QUANTITIES.flatMap((quantity, index) => {
        const values = [
          ["ideal", answer.ideal],
          ["from pulses", answer.actual],
        ].flatMap(([name, of]) => {
          const value = /** @type {import("../../state/types.js").Readings | null} */ (of)?.at_a[index];
          return value === undefined ? [] : [`${name} ${short(value * scale)}`];
        });
        return values.length ? [`${quantity}: ${values.join(", ")} ${unitFor(state, quantity)}.`] : [];
      });
      say(
        byId("motion-spoken"),
        `Cursor ${which.toUpperCase()} at ${time(cycle / (state.result?.summary.clock_hz ?? 1))}. ${texts.join(" ")}`,
      );
    }, SPEAK_MS);
  }

  /** Follows the shown time, but leaves the frames between to the pulses. */
  function follow() {
    const wait = asked + FOLLOW_MS - performance.now();
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
      const axes = selected(state)?.channels ?? 1;
      /** @type {HTMLElement} */ (axisSelect.parentElement).hidden = axes === 1;
      options(
        axisSelect,
        Array.from({ length: axes }, (_, i) => [String(i), String(i)]),
        String(state.axis),
      );
      options(unitSelect, unitsOf(state), unitOf(state).name);
    }
    compare.render(state, before);
    const other = before?.axis !== state.axis || before?.result !== state.result || before?.baseline !== state.baseline;
    const moved = other || before?.window !== state.window;
    if (before?.window !== state.window || other || before?.unit !== state.unit) record.render(state);
    if (before && byKeys && before.cursors !== state.cursors)
      speak(state, before.cursors.b === state.cursors.b ? "a" : "b");
    if (before?.cursors !== state.cursors || other || before?.unit !== state.unit)
      between.render(state).then(() => say(byId("motion-sentence"), sentence(now())), unlessDropped);
    if (before && !other && before.window !== state.window && before.difference === state.difference) return follow();
    if (moved || before?.difference !== state.difference || (state.difference && before?.unit !== state.unit))
      return refresh(state);
    if (before?.unit !== state.unit) paint(state);
    else if (overlaid(before, state)) paintCursor(state);
    return undefined;
  }
  return { render };
}
