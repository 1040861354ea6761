/** The charts of the tab Sine: THD and Euclidean distance over d1, with the selected, the current and the best row. */
import { element, fill, setText } from "../../dom.js";
import { registerCommands } from "../../shell/commands.js";
import { cleared, color, draw, fit, watch } from "../../time/plot.js";
import { captionOf, indexAt, movedBy, rowOf, valueText, whyNoChart } from "./sine_sweep.js";

/** @typedef {import("./sine_sweep.js").Rows} Rows */
/** @typedef {import("./sine_sweep.js").Row} Row */
/** @typedef {import("./sine_sweep.js").Quantity} Quantity */
/** @typedef {{rows: Rows | null, selected: number | null, best: Row | null, current: Row | null, quantity: Quantity, sensor: number | undefined, order: number}} Shown */

const GUTTER = 58;

/** @param {{shown: () => Shown, select: (index: number | null) => void, use: () => void}} page */
export function createSineCharts({ shown, select, use }) {
  const thdCanvas = element("canvas", { role: "img", "aria-label": "THD over d1" });
  const distanceCanvas = element("canvas", { role: "img", "aria-label": "Euclidean distance over d1" });
  const overlay = element("canvas", { class: "overlay", "aria-hidden": "true" });
  const noThd = element("p", { class: "study-note no-chart" });
  noThd.hidden = true;
  const thdCaption = element("div", { class: "caption" });
  const distanceCaption = element("div", { class: "caption" }, element("span", {}, "Euclidean distance Ev over d1"));
  const root = element(
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
  /** Plot area of both charts; the chart of the THD may be hidden. @type {import("../../state/types.js").Plot | null} */
  let plot = null;

  watch(root, paint);
  root.addEventListener("pointermove", (event) => select(rowUnder(event)));
  root.addEventListener("click", (event) => {
    select(rowUnder(event));
    use();
  });
  const move = (/** @type {number} */ by) => select(movedBy(shown().rows, shown().selected, by));
  registerCommands(root, "Sine: figure 4", [
    { keys: ["ArrowRight", "ArrowUp"], text: "next d1", run: () => move(1) },
    { keys: ["ArrowLeft", "ArrowDown"], text: "previous d1", run: () => move(-1) },
    { keys: ["PageUp"], text: "20 forward", run: () => move(20) },
    { keys: ["PageDown"], text: "20 back", run: () => move(-20) },
    { keys: ["Home"], text: "minimum d1", run: () => select(0) },
    { keys: ["End"], text: "maximum d1", run: () => move(1e9) },
    { keys: ["Enter", "Space"], text: "use this d1", run: use },
  ]);

  /** @param {PointerEvent | MouseEvent} event */
  function rowUnder({ clientX }) {
    const { rows, selected } = shown();
    if (!plot || !rows) return null;
    return indexAt(
      (clientX - root.getBoundingClientRect().left - plot.left) / (plot.right - plot.left),
      rows,
      selected,
    );
  }

  function paint() {
    const { rows, quantity, sensor, order } = shown();
    fill(thdCaption, element("span", {}, captionOf(quantity, sensor, order)));
    const why = whyNoChart(rows, quantity, sensor);
    [thdCanvas.hidden, noThd.hidden] = [why !== "", why === ""];
    setText(noThd, why);
    if (rows && rows.d1.length > 1) {
      if (why === "")
        line(
          thdCanvas,
          rows.d1,
          rows[quantity].map((ratio) => 100 * ratio),
          "--ideal",
        );
      plot = line(distanceCanvas, rows.d1, rows.euclidean, "--actual");
      fit(overlay);
    }
    mark();
  }

  function mark() {
    const { rows, selected, best, current, quantity } = shown();
    const selectedRow = rowOf(rows, selected);
    root.setAttribute("aria-valuemax", String((rows?.d1.length ?? 1) - 1));
    root.setAttribute("aria-valuenow", String(selected ?? 0));
    root.setAttribute("aria-valuetext", valueText(selectedRow, quantity));
    const layer = cleared(overlay);
    if (!layer || !plot || !rows) return;
    const { context } = layer;
    context.font = "11px system-ui, sans-serif";
    /** @type {[Row | null, string, number[], string][]} */
    const lines = [
      [current, "--ink", [5, 4], "current"],
      [best, "--enable", [2, 3], "best by position"],
      [selectedRow, "--axis", [], ""],
    ];
    const [low, high] = [rows.d1[0], rows.d1[rows.d1.length - 1]];
    for (const [row, ink, dash, name] of lines) {
      if (!row || row.d1 < low || row.d1 > high) continue;
      const x = Math.round(plot.left + ((row.d1 - low) / (high - low)) * (plot.right - plot.left)) + 0.5;
      context.strokeStyle = context.fillStyle = color(ink);
      context.setLineDash(dash);
      markAt(context, plot, x, name);
    }
    context.setLineDash([]);
  }

  /** A vertical line through both charts, with its name in the first. @param {CanvasRenderingContext2D} context @param {import("../../state/types.js").Plot} plot @param {number} x @param {string} name */
  function markAt(context, { top, bottom }, x, name) {
    const tops = [thdCanvas, distanceCanvas]
      .filter(({ hidden }) => !hidden)
      .map((canvas) => canvas.offsetTop + (canvas.parentElement?.offsetTop ?? 0));
    for (const y of tops) {
      context.beginPath();
      context.moveTo(x, y + top);
      context.lineTo(x, y + bottom);
      context.stroke();
    }
    if (name) context.fillText(name, x + 4, tops[0] + top + (name === "current" ? 11 : 24));
  }
  return { root, paint, mark };
}

/** @param {HTMLCanvasElement} canvas @param {Float64Array} d1 @param {Float64Array} y @param {string} ink */
function line(canvas, d1, y, ink) {
  return draw(canvas, {
    x: { min: d1[0], max: d1[d1.length - 1], unit: "", prefix: false, label_px: 20 },
    y: { min: 0, max: 1.05 * Math.max(1e-9, ...y.filter(Number.isFinite)), unit: "", prefix: false, label_px: GUTTER },
    series: Number.isFinite(y[0]) ? [{ color: color(ink), opacity: 1, width: 1.5, x: d1, shape: { line: { y } } }] : [],
  });
}
