/** Draws charts on the main thread, because plotters-canvas measures text in the document. */
import { compiled } from "../engine/wasm.js";
import init, { chart_svg, draw_chart } from "../pkg/stepscope_wasm.js";

/** @typedef {import("../state/types.js").Plot} Plot */

/** Width of the labels in CSS pixels; the same in all views, so that time axes are aligned. */
export const GUTTER = 68;
/** Free space at the right of a plotting area, as the charts draw it. */
export const MARGIN = 26;

/** Charts are drawn at double size, because they only have whole pixels. */
export const CHART_RATIO = 2;

let loaded = /** @type {Promise<unknown> | null} */ (null);

/** Loads the charts. */
export function load() {
  loaded ??= compiled().then((module) => init({ module_or_path: module }));
  return loaded;
}

/** Device pixels per CSS pixel, at most 2. */
export function ratio() {
  return Math.min(2, Math.max(1, window.devicePixelRatio || 1));
}

/**
 * Sizes a canvas to its box and clears it.
 * @param {HTMLCanvasElement} canvas
 * @param {number} [scale]  Device pixels per CSS pixel.
 * @returns {{width: number, height: number, ratio: number}}  CSS pixels.
 */
export function fit(canvas, scale = ratio()) {
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  canvas.width = Math.max(1, Math.round(width * scale));
  canvas.height = Math.max(1, Math.round(height * scale));
  fitted.set(canvas, [width, scale, height]);
  return { width, height, ratio: scale };
}

const probe = document.createElement("span");
/** @type {Map<string, string>} */
const known = new Map();

/**
 * A color of the page as `#rrggbb`, also with forced colors.
 * @param {string} name  Custom property, such as `--ideal`.
 */
export function color(name) {
  const found = known.get(name);
  if (found) return found;
  if (!probe.isConnected) {
    probe.className = "probe";
    document.body.append(probe);
  }
  probe.style.color = `var(${name})`;
  const parts = getComputedStyle(probe).color.match(/[\d.]+/g) ?? ["128", "128", "128"];
  const hex = `#${parts
    .slice(0, 3)
    .map((part) => Math.round(Number(part)).toString(16).padStart(2, "0"))
    .join("")}`;
  known.set(name, hex);
  return hex;
}

// This listener is registered before the listeners of the views, so they redraw with the new colors.
document.addEventListener("themechange", () => known.clear());

let family = "";

/** The fonts of the page; read once, because reading causes a layout. */
export function font() {
  family ||= getComputedStyle(document.body).fontFamily;
  return family;
}

/**
 * Clears a canvas that `fit` has sized. It causes no layout, so it is fast enough to follow a pointer.
 * @param {HTMLCanvasElement} canvas
 */
export function cleared(canvas) {
  const context = canvas.getContext("2d");
  const [, scale, height] = fitted.get(canvas) ?? [0, 1, 0];
  context?.setTransform(scale, 0, 0, scale, 0, 0);
  context?.clearRect(0, 0, canvas.width, canvas.height);
  return context && { context, height };
}

/** Width, scale and height of each canvas from the last `fit`. @type {WeakMap<HTMLCanvasElement, [number, number, number]>} */
const fitted = new WeakMap();

/**
 * @typedef {{min: number, max: number, unit: string, prefix: boolean, label_px: number, ticks?: number[], labels?: string}} Axis
 * @typedef {{color: string, opacity: number, width: number, dash?: number, x: Float64Array | number[],
 *   shape: {line: {y: ArrayLike<number>}} | {band: {min: ArrayLike<number>, max: ArrayLike<number>}}
 *     | {stems: {y: ArrayLike<number>, shift: number}}}} Series
 * @typedef {{x: Axis, y: Axis, series: Series[]}} Chart
 */

/**
 * Draws one chart.
 * @param {HTMLCanvasElement} canvas
 * @param {Chart} chart
 * @returns {Plot | null}  null if the canvas is too small.
 */
export function draw(canvas, chart) {
  const size = fit(canvas, CHART_RATIO);
  if (size.width < GUTTER + 40 || size.height < 30) return null;
  return draw_chart(canvas, spec(chart));
}

/** A chart for the wasm module. @param {Chart} chart */
function spec({ x, y, series }) {
  return {
    ratio: CHART_RATIO,
    font: font(),
    font_px: 11,
    x,
    y,
    series,
    colors: { label: color("--quiet"), axis: color("--axis"), grid: color("--grid") },
  };
}

/** A chart on a hidden canvas. @param {Chart} chart @param {number} width @param {number} height */
export function picture(chart, width, height) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width * CHART_RATIO, height * CHART_RATIO];
  draw_chart(canvas, spec(chart));
  return canvas;
}

/** A chart as the text of an SVG element at a position. @param {Chart} chart @param {number} x @param {number} y @param {number} width @param {number} height */
export function drawing(chart, x, y, width, height) {
  const [w, h] = [width * CHART_RATIO, height * CHART_RATIO];
  const opening = `<svg x="${x}" y="${y}" width="${width}" height="${height}" viewBox="0 0 ${w} ${h}">`;
  return chart_svg(w, h, spec(chart)).replace(/^[\s\S]*?<svg[^>]*>/, opening);
}

/** Calls back when an element's size changes or the theme does. @param {Element} element @param {() => void} redraw */
export function watch(element, redraw) {
  new ResizeObserver(redraw).observe(element);
  document.addEventListener("themechange", redraw);
}
