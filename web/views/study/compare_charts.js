/** The charts of the tab Compare: one for all speeds, one for each acceleration, and the legend of their lines. */
import { element, setText } from "../../dom.js";
import { cleared, color, draw, watch } from "../../time/plot.js";
import { isBounded, POINTS, rangeOf } from "./compare_costs.js";

/** @typedef {import("./compare_costs.js").Cost} Cost */

/** Color and dash of each row of the core; lines of one color have different dashes. @type {[string, number][]} */
const LOOKS = [
  ["--actual", 0],
  ["--ideal", 2],
  ["--enable", 4],
  ["--wire", 7],
  ["--ink", 10],
  ["--reply", 15],
  ["--actual", 15],
  ["--ideal", 10],
  ["--enable", 0],
  ["--wire", 2],
  ["--ink", 4],
  ["--reply", 7],
];
const GUTTER = 68;
const SMALL_GUTTER = 44;

/** @param {() => {rows: Cost[], duration_s: number}} shown @param {() => Iterable<HTMLCanvasElement>} keys  The legend in the table, in the order of the rows. */
export function createCompareCharts(shown, keys) {
  const speeds = element("canvas", {
    id: "compare-speeds",
    role: "img",
    "aria-label": "Speed of every kind of motion over time",
  });
  const small = LOOKS.map(() => ({
    name: element("span"),
    canvas: element("canvas", { role: "img", "aria-label": "Acceleration" }),
    key: element("canvas", { class: "study-key", "aria-hidden": "true" }),
  }));
  const accelerations = element(
    "div",
    { class: "study-multiples" },
    ...small.map(({ name, canvas, key }) =>
      element("div", {}, element("p", { class: "study-caption" }, key, name), canvas),
    ),
  );
  watch(speeds, paint);

  function paint() {
    const { rows, duration_s } = shown();
    if (rows.length === 0) return;
    const x = Float64Array.from({ length: POINTS }, (_, at) => (duration_s * at) / (POINTS - 1));
    const time = { min: 0, max: duration_s, unit: "s", prefix: true, label_px: 20 };
    const axis = { unit: "", prefix: true };
    const line = (/** @type {Float64Array | undefined} */ y, /** @type {number} */ at, /** @type {number} */ dash) =>
      y ? [{ color: color(LOOKS[at][0]), opacity: 1, width: 1.8, dash, x, shape: { line: { y } } }] : [];
    draw(speeds, {
      x: time,
      y: { ...axis, ...rangeOf(rows, "at_speed"), label_px: GUTTER },
      series: rows.flatMap(({ at_speed }, at) => line(at_speed, at, LOOKS[at][1])),
    });
    const range = rangeOf(rows.filter(isBounded), "at_acceleration");
    for (const [at, { name, canvas, key }] of small.entries()) {
      const row = rows[at];
      setText(name, row.name);
      canvas.setAttribute("aria-label", `Acceleration, ${row.name}`);
      /** @type {HTMLElement} */ (canvas.parentElement).hidden = !(row.at_acceleration && isBounded(row));
      draw(canvas, {
        x: time,
        y: { ...axis, ...range, label_px: SMALL_GUTTER },
        series: line(row.at_acceleration, at, 0),
      });
      drawKey(key, at);
    }
    for (const [at, canvas] of [...keys()].entries()) drawKey(canvas, at);
  }

  function clear() {
    for (const { canvas } of [{ canvas: speeds }, ...small]) cleared(canvas);
  }
  return { speeds, accelerations, paint, clear };
}

/** Draws a piece of a curve's line as its legend. @param {HTMLCanvasElement} canvas @param {number} at */
function drawKey(canvas, at) {
  const [ink, dash] = LOOKS[at];
  [canvas.width, canvas.height] = [88, 16];
  const context = canvas.getContext("2d");
  if (!context) return;
  context.strokeStyle = color(ink);
  context.lineWidth = 4;
  context.setLineDash([2 * dash, 2 * dash]);
  context.moveTo(0, 8);
  context.lineTo(88, 8);
  context.stroke();
}
