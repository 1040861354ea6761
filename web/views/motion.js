/** The motion view: position, speed and acceleration over one time axis, the ideal curve over what the pulses make. */
import { byId, options, say } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { count, short, si, time } from "../state/number.js";
import { GUTTER, MARGIN, color, draw, fit, watch } from "../time/plot.js";
import { lookedAt, shown } from "../state/state.js";
import { drawCursors, overlaid } from "../time/cursors.js";
import { gestures } from "../time/timeline.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").MotionColumns} MotionColumns */

const CHARTS = /** @type {const} */ (["position", "speed", "acceleration"]);
/** Height of the time axis's labels under the lowest chart, in CSS pixels. */
const TIME_PX = 20;

/** @param {{engine: import("../engine/engine.js").Engine} & import("../time/timeline.js").Page} page */
export function createMotion({ engine, dispatch, now }) {
  const stack = byId("charts");
  const overlay = /** @type {HTMLCanvasElement} */ (byId("charts-cursor"));
  const axisSelect = /** @type {HTMLSelectElement} */ (byId("motion-axis"));
  const unitSelect = /** @type {HTMLSelectElement} */ (byId("motion-unit"));
  /** @type {MotionColumns | null} */
  let columns = null;
  let plot = { left: GUTTER, right: GUTTER + 1 };

  axisSelect.addEventListener("change", () => dispatch({ type: "axis", axis: Number(axisSelect.value) }));
  unitSelect.addEventListener("change", () => dispatch({ type: "unit", unit: /** @type {State["unit"]} */ (unitSelect.value) }));
  gestures(stack, () => plot, { dispatch, now });
  watch(stack, () => refresh(now()));

  /** @param {State} state */
  async function refresh(state) {
    plot = { left: GUTTER, right: Math.max(GUTTER + 1, stack.clientWidth - MARGIN) };
    if (!state.result || stack.clientWidth < 60) return;
    const { start, end } = shown(state);
    const clock = state.result.summary.clock_hz;
    const wanted = Math.max(16, Math.round(plot.right - plot.left));
    const answer = await engine.latest("motion", "motion", state.axis, start / clock, end / clock, wanted).catch(unlessDropped);
    if (!answer) return;
    columns = answer;
    paint(now());
  }

  /** @param {State} state */
  function paint(state) {
    if (!columns || !state.result) return;
    const { scale, unit } = unitOf(state);
    const x = axisOf(state);
    for (const [index, name] of CHARTS.entries()) {
      const canvas = /** @type {HTMLCanvasElement} */ (byId(`chart-${name}`));
      const label = `${unit}${["", "/s", "/s²"][index]}`;
      const bands = bandsOf(columns, name, scale);
      const range = rangeOf(bands, name !== "position");
      const last = index === CHARTS.length - 1;
      say(byId(`caption-${name}`), `${name}, ${label}`);
      draw(canvas, {
        x: { ...x, label_px: last ? TIME_PX : 0 },
        y: { ...range, unit: "", prefix: true, label_px: GUTTER },
        series: bands.map(({ color: ink, opacity, width, min, max }) => ({
          color: color(ink), opacity, width, x: /** @type {MotionColumns} */ (columns).x, shape: { band: { min, max } } })),
      });
      const text = bands.length === 0 ? "nothing to show" : `from ${short(range.low)} to ${short(range.high)} ${label}`;
      canvas.setAttribute("aria-label", `${name} over time: ${text}`);
    }
    const note = withoutAcceleration(columns);
    byId("no-acceleration").hidden = note === "";
    say(byId("no-acceleration"), note);
    say(byId("motion-sentence"), `Axis ${state.axis}, ${si(x.min, "s")} to ${si(x.max, "s")}.`);
    paintCursor(state);
  }

  /** The cursors, on a canvas of their own: a moving pointer redraws nothing else. @param {State} state */
  function paintCursor(state) {
    const { height, ratio } = fit(overlay);
    const context = overlay.getContext("2d");
    if (!context || !columns || !state.result) return;
    context.scale(ratio, ratio);
    drawCursors(context, state, plot, height - TIME_PX);
    read(state);
  }

  /** Values under the pointer, else at cursor A. @param {State} state */
  function read(state) {
    const { start, end } = shown(state);
    const cycle = [state.hover, state.cursors.a].find((at) => at !== null && at >= start && at <= end) ?? null;
    const { scale, unit } = unitOf(state);
    const clock = state.result?.summary.clock_hz ?? 1;
    const at = columns && cycle !== null ? columnAt(columns, cycle / clock) : -1;
    say(byId("motion-time"), cycle === null ? "" : `${time(cycle / clock)} · cycle ${count(cycle)}`);
    for (const [index, name] of CHARTS.entries()) {
      const label = `${unit}${["", "/s", "/s²"][index]}`;
      const values = columns && at >= 0 ? bandsOf(columns, name, scale).map(({ name: of, min, max }) => {
        const [low, high] = [min[at], max[at]];
        if (!Number.isFinite(low)) return "";
        const same = Math.abs(high - low) <= 1e-6 * Math.max(1e-9, Math.abs(high));
        return `${of} ${same ? short(low) : `${short(low)} to ${short(high)}`}`;
      }).filter(Boolean) : [];
      say(byId(`read-${name}`), values.length ? `${values.reverse().join("  ·  ")} ${label}` : "");
    }
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    const axes = lookedAt(state)?.channels ?? 1;
    options(axisSelect, Array.from({ length: axes }, (_, i) => [String(i), String(i)]), String(state.axis));
    options(unitSelect, unitsOf(state), unitOf(state).name);
    const moved = before?.window !== state.window || before?.axis !== state.axis || before?.result !== state.result;
    if (moved) return refresh(state);
    if (before?.unit !== state.unit) paint(state);
    else if (overlaid(before, state)) paintCursor(state);
    return undefined;
  }
  return { render };
}

/** @param {State} state */
function axisOf(state) {
  const { start, end } = shown(state);
  const clock = state.result?.summary.clock_hz ?? 1;
  return { min: start / clock, max: end / clock, unit: "s", prefix: true, label_px: 0 };
}

/** What follows from the axis on show. @param {State} state */
function axisOnShow(state) {
  return state.derived?.controllers[state.result?.controller ?? 0]?.axes[state.axis];
}

/** @param {State} state @returns {[string, string][]} */
function unitsOf(state) {
  const axis = axisOnShow(state);
  return [["steps", "steps"], ...(axis?.step_mm ? [["mm", "mm"]] : []), ...(axis?.step_deg ? [["deg", "°"]] : [])]
    .map(([name, text]) => [name, text]);
}

/** The chosen unit, or steps where the axis has no such unit. @param {State} state */
function unitOf(state) {
  const axis = axisOnShow(state);
  if (state.unit === "mm" && axis?.step_mm) return { name: "mm", unit: "mm", scale: axis.step_mm };
  if (state.unit === "deg" && axis?.step_deg) return { name: "deg", unit: "°", scale: axis.step_deg };
  return { name: "steps", unit: "steps", scale: 1 };
}

/**
 * @param {MotionColumns} columns
 * @param {"position" | "speed" | "acceleration"} name
 * @param {number} scale
 */
function bandsOf(columns, name, scale) {
  const scaled = (/** @type {Float64Array} */ values) => (scale === 1 ? values : values.map((value) => value * scale));
  const made = name === "position" ? [columns.made_position_min, columns.made_position_max]
    : name === "speed" ? [columns.made_speed_min, columns.made_speed_max] : null;
  const bands = [];
  if (made) bands.push({ name: "made", color: "--made", opacity: 0.55, width: 4, min: scaled(made[0]), max: scaled(made[1]) });
  if (columns.has_ideal) {
    const [min, max] = name === "position" ? [columns.position_min, columns.position_max]
      : name === "speed" ? [columns.speed_min, columns.speed_max] : [columns.acceleration_min, columns.acceleration_max];
    bands.push({ name: "ideal", color: "--ideal", opacity: 1, width: 1.6, min: scaled(min), max: scaled(max) });
  }
  return bands;
}

/** Why the chart of the acceleration looks empty, if so. @param {MotionColumns} columns */
function withoutAcceleration({ has_ideal, acceleration_min, acceleration_max, speed_min, speed_max }) {
  if (!has_ideal) return "No motion is planned for this channel, so it has no ideal curve and no acceleration.";
  const still = (/** @type {number} */ value) => !(Math.abs(value) > 0);
  if (!acceleration_min.every(still) || !acceleration_max.every(still)) return "";
  const [low, high] = [Math.min(...speed_min), Math.max(...speed_max)];
  return high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high)) ? "The speed only jumps here; between the jumps there is no acceleration." : "The speed does not change here; no acceleration.";
}

/** Least and greatest value, and a range around them that leaves air. @param {{min: Float64Array, max: Float64Array}[]} bands @param {boolean} zero */
function rangeOf(bands, zero) {
  let [low, high] = [Infinity, -Infinity];
  for (const { min, max } of bands) {
    for (const value of min) if (value < low) low = value;
    for (const value of max) if (value > high) high = value;
  }
  if (low > high) [low, high] = [0, 1];
  const [from, to] = zero ? [Math.min(0, low), Math.max(0, high)] : [low, high];
  const air = (to - from) * 0.08 || Math.abs(to) * 1e-3 || 1;
  return { low, high, min: from - air, max: to + air };
}

/** @param {MotionColumns} columns @param {number} seconds */
function columnAt({ x }, seconds) {
  if (x.length < 2) return x.length - 1;
  const index = Math.round((seconds - x[0]) / (x[1] - x[0]));
  return Math.min(x.length - 1, Math.max(0, index));
}
