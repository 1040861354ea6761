/** The charts of the tab Motor: torque over rate, resonance, and the supply current of one step and of the run. */
import { element, fill } from "../../dom.js";
import { color, draw, GUTTER, watch } from "../../time/plot.js";
import { shapeOf, swatch } from "../lines.js";
import { extent, MAP, settledLimit } from "./motor_findings.js";

/** @typedef {import("./motor_findings.js").Findings} Findings */
/** @typedef {ReturnType<typeof chart>} Chart */

const AXIS = { unit: "", prefix: true, label_px: GUTTER };
/** Maximum oscillation that the resonance map draws, in full steps. */
const MAX_OSCILLATION = 4;

/** @param {string} text @param {string} label */
function chart(text, label) {
  const canvas = element("canvas", { role: "img", "aria-label": label });
  const keys = element("span");
  const root = element(
    "div",
    { class: "chart torque-chart" },
    element("div", { class: "caption" }, element("span", {}, text), keys),
    canvas,
  );
  return { root, canvas, keys };
}

/** @param {string} ink @param {ArrayLike<number>} x @param {ArrayLike<number>} y @param {{width?: number, dash?: number}} [look] */
const line = (ink, x, y, { width = 1.8, dash = 0 } = {}) => ({
  color: color(ink),
  opacity: 1,
  width,
  dash,
  x: Float64Array.from(x),
  shape: { line: { y } },
});

/** @param {string} ink @param {string} text @param {boolean} [dashed] */
const key = (ink, text, dashed = false) => element("span", {}, swatch(ink, dashed), ` ${text} `);

/** @param {() => Findings | null} shown  Null where the charts are not visible. */
export function createMotorCharts(shown) {
  const torque = chart("Torque-speed curve, mN·m over steps/s: ", "Torque-speed curve");
  const map = chart("Oscillation at each rate, full steps over full steps/s: ", "Resonance");
  const step = chart("Supply current of one step at the sensor, A over s: ", "Supply current of one step");
  const pair = chart("Supply current of the run at the sensor, A over s: ", "Supply current of the run");
  for (const { root } of [torque, map, step, pair]) watch(root, paint);

  function paint() {
    const findings = shown();
    if (!findings) return;
    paintTorque(torque, findings);
    paintMap(map, findings);
    paintStep(step, findings);
    paintPair(pair, findings);
  }
  return { torque: torque.root, map: map.root, step: step.root, pair: pair.root, paint };
}

/** @param {Chart} chart @param {Findings} findings */
function paintTorque({ root, canvas, keys }, { torque, start, pull }) {
  root.hidden = torque === null;
  if (!torque) return;
  const { rate, available, needed } = torque;
  const needs = needed.filter((value) => value > 0);
  const maxTorque = Math.max(...available, ...needs);
  const marks = [
    ...(start === undefined ? [] : [line("--enable", [start, start], [0, 2 * maxTorque], { width: 1.5 })]),
    ...(pull === undefined ? [] : [line("--error", [pull, pull], [0, 2 * maxTorque], { width: 1.5, dash: 4 })]),
  ];
  const positive = available.map((value) => Math.max(value, 0));
  const needStems = { ...line("--actual", rate, []), opacity: 0.75, shape: { stems: { y: needed, shift: 0 } } };
  draw(canvas, {
    x: { min: 0, max: rate[rate.length - 1], unit: "steps/s", prefix: true, label_px: 20 },
    y: { ...AXIS, prefix: false, min: 0, max: 1.08 * maxTorque },
    series: [...(needs.length > 0 ? [needStems] : []), line("--ideal", rate, positive), ...marks],
  });
  fill(
    keys,
    key("--ideal", "static curve"),
    ...(needs.length > 0 ? [key("--actual", "path of the plan")] : []),
    ...(start === undefined ? [] : [key("--enable", "start-stop")]),
    ...(pull === undefined ? [] : [key("--error", "pull-out", true)]),
  );
}

/** @param {Chart} chart @param {Findings} findings */
function paintMap({ root, canvas, keys }, { oscillation, loses }) {
  root.hidden = oscillation.length === 0;
  if (oscillation.length === 0) return;
  const x = Float64Array.from(oscillation, (_, at) => MAP.from + at * MAP.rung);
  const y = oscillation.map((value) => Math.min(value, MAX_OSCILLATION));
  const lost = y.map((value, at) => (loses[at] ? value : Number.NaN));
  draw(canvas, {
    x: { min: 0, max: MAP.to, unit: "", prefix: false, label_px: 20 },
    y: { ...AXIS, prefix: false, min: 0, max: Math.max(0.2, 1.08 * Math.max(...y)) },
    series: [
      { ...line("--error", x, []), opacity: 0.6, width: 3, shape: { stems: { y: lost, shift: 0 } } },
      line("--actual", x, y),
    ],
  });
  fill(keys, key("--actual", "oscillation, peak to peak, drawn up to 4"), key("--error", "loses steps"));
}

/** @param {Chart} chart @param {Findings} findings */
function paintStep({ root, canvas, keys }, { step }) {
  root.hidden = step === null;
  if (!step) return;
  const limit = settledLimit(step);
  const ends = [step.x[0], step.x[step.x.length - 1]];
  draw(canvas, {
    x: { min: ends[0], max: ends[1], unit: "s", prefix: true, label_px: 20 },
    y: { ...AXIS, ...extent([step.y]) },
    series: [
      line("--axis", ends, [step.rest_a, step.rest_a], { width: 1 }),
      line("--ideal", ends, [limit, limit], { width: 1, dash: 4 }),
      line("--actual", step.x, step.y),
    ],
  });
  fill(keys, key("--axis", "at rest"), key("--ideal", "settled below", true));
}

/** @param {Chart} chart @param {Findings} findings */
function paintPair({ root, canvas, keys }, { pair }) {
  root.hidden = pair === null;
  if (!pair) return;
  const last = Math.max(...pair.map(({ x }) => x[x.length - 1]));
  draw(canvas, {
    x: { min: 0, max: last, unit: "s", prefix: true, label_px: 20 },
    y: { ...AXIS, ...extent(pair.flatMap(({ min, max }) => [min, max])) },
    series: pair.map((curve, at) => ({
      ...line(["--ideal", "--actual"][at], curve.x, curve.min, { width: 1.4 }),
      shape: shapeOf(curve),
    })),
  });
  fill(keys, key("--ideal", "simultaneous"), key("--actual", "staggered"));
}
