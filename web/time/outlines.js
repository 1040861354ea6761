/** Draws many curves behind a chart, without the copies that a chart in wasm needs, so that sixteen axes follow a moving window. */
import { CHART_RATIO } from "./plot.js";

/** @typedef {import("./plot.js").Chart} Chart */

/**
 * @param {HTMLCanvasElement} canvas  With the chart drawn.
 * @param {import("../state/types.js").Plot} plot
 * @param {Chart} chart  Its axes, and the curves as lines or bands.
 */
export function drawOutlines(canvas, plot, { x: across, y: up, series }) {
  const context = canvas.getContext("2d");
  if (!context || series.length === 0) return;
  const [xScale, yScale] = [
    (plot.right - plot.left) / (across.max - across.min),
    (plot.bottom - plot.top) / (up.max - up.min),
  ];
  context.save();
  context.setTransform(CHART_RATIO, 0, 0, CHART_RATIO, 0, 0);
  context.globalCompositeOperation = "destination-over";
  context.beginPath();
  context.rect(plot.left, plot.top, plot.right - plot.left, plot.bottom - plot.top);
  context.clip();
  context.lineJoin = "round";
  for (const { color, opacity, width, dash = 0, x, shape } of series) {
    const parts = "line" in shape ? [shape.line.y] : "band" in shape ? [shape.band.min, shape.band.max] : [];
    [context.strokeStyle, context.globalAlpha, context.lineWidth] = [color, opacity, width];
    context.setLineDash(dash ? [dash, dash] : []);
    context.beginPath();
    for (let at = 0; at < x.length; at++) {
      const px = plot.left + (x[at] - across.min) * xScale;
      for (const part of parts) context.lineTo(px, plot.bottom - (part[at] - up.min) * yScale);
    }
    context.stroke();
  }
  context.restore();
}
