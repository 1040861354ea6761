/** Exports charts of motion and spectrum as PNG, SVG and CSV. */
import { unlessDropped } from "../engine/engine.js";
import { csv } from "../shell/tables.js";
import { time } from "../state/number.js";
import { shown } from "../state/time_window.js";
import { color, drawing, font, picture } from "../time/plot.js";
import { bandsOf, chartOf, quantitiesOf } from "./motion/bands.js";
import { requestColumns } from "./motion/request_columns.js";
import { motorPanels, motorValues as motorTable } from "./motor/sheet.js";
import { selectedSpectrum, spectrumChart } from "./spectrum/chart.js";
import { distortion, namedSpectra, nameOf, overFrequency, UNITS } from "./spectrum/harmonics.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../engine/engine.js").Engine} Engine */
/** @typedef {{name: string, ink: string, dash: number}} Key  An entry of the legend. */
/** @typedef {{title: string, note: string, legend: Key[], panels: {caption: string, chart: import("../time/plot.js").Chart, height: number}[]}} Sheet */

/** Width of a picture and height of a chart in CSS pixels; drawn at double size. */
const WIDTH = 1000;
const PANEL = 190;
/** Height of title and legend, and of the caption of a chart. */
const HEAD = 54;
const CAPTION = 20;
const COLUMNS = WIDTH - 94;

/** @param {State} state @param {Engine} engine */
async function requestMotion(state, engine) {
  const reply = await requestColumns(engine, state, shown(state), COLUMNS, "file").catch(unlessDropped);
  if (!reply) throw new Error("there is no motion to save");
  return reply;
}

/** @param {Engine} engine @returns {Promise<import("../state/types.js").Spectra>} */
async function requestSpectra(engine) {
  const reply = await engine.request("spectrum");
  if (!reply?.ideal && !reply?.pulses) throw new Error(reply?.note || "there is no spectrum to save");
  return reply;
}

/** @param {State} state */
function titleOf({ scenario, result }) {
  const digest = result?.summary.controllers[result.controller].digest ?? "";
  return { title: scenario.title || "Stepscope", note: `digest ${digest}` };
}

/** @param {State} state @param {Engine} engine @returns {Promise<Sheet>} */
export async function motionSheet(state, engine) {
  const columns = await requestMotion(state, engine);
  const charts = quantitiesOf(state, columns).map((quantity) => chartOf(state, columns, quantity));
  const { start, end } = shown(state);
  const clock = state.result?.summary.clock_hz ?? 1;
  const { title, note } = titleOf(state);
  const legend = new Map(
    charts.flatMap(({ bands }) =>
      bands.map(({ name, ink, dash }) => [
        name,
        { name: name === "baseline" ? `baseline: ${state.baseline?.title}` : name, ink, dash },
      ]),
    ),
  );
  return {
    title,
    note: `axis ${state.axis} · ${time(start / clock)} to ${time(end / clock)} · ${note}`,
    legend: [...legend.values()],
    panels: charts.map(({ caption, unit, chart }) => ({
      caption: `${caption}, ${unit}`,
      chart,
      height: PANEL + chart.x.label_px,
    })),
  };
}

/** @param {State} state @param {Engine} engine @returns {Promise<Sheet>} */
export async function motorSheet(state, engine) {
  const { about, legend, panels } = await motorPanels(state, engine, COLUMNS);
  const { title, note } = titleOf(state);
  return { title, note: `${about} · ${note}`, legend, panels };
}

/** The visible curves of the motor view as CSV. @param {State} state @param {Engine} engine */
export function motorValues(state, engine) {
  return motorTable(state, engine, COLUMNS);
}

/** @param {State} state @param {Engine} engine @returns {Promise<Sheet>} */
export async function spectrumSheet(state, engine) {
  const found = await requestSpectra(engine);
  const { quantity, db } = selectedSpectrum();
  const { title, note } = titleOf(state);
  const all = namedSpectra(found);
  const thd = all[0][1].periodic ? `${distortion(found, quantity)} · ` : "";
  return {
    title,
    note: `${thd}${note}`,
    legend: all.map(([name]) => ({ name, ink: name === "ideal" ? "--ideal" : "--actual", dash: 0 })),
    panels: [
      {
        caption: `amplitude of ${nameOf(quantity)}, ${db ? "dB of the fundamental" : UNITS[quantity]}, over ${overFrequency(all[0][1])}`,
        chart: spectrumChart(found, quantity, db, WIDTH),
        height: 2 * PANEL,
      },
    ],
  };
}

/** @param {Sheet} sheet */
function heightOf({ panels }) {
  return panels.reduce((sum, { height }) => sum + CAPTION + height, HEAD + 8);
}

/**
 * Draws title, legend, captions and charts at their positions.
 * @param {Sheet} sheet
 * @param {{text: (text: string, x: number, y: number, bold: boolean, ink: string) => number, key: (key: Key, x: number, y: number) => void,
 *   chart: (chart: import("../time/plot.js").Chart, x: number, y: number, width: number, height: number) => void}} pen  `text` returns the width of the text.
 */
function drawSheet({ title, note, legend, panels }, pen) {
  pen.text(title, 12, 20, true, "--ink");
  let x = 12;
  for (const key of legend) {
    pen.key(key, x, 36);
    x += 26 + pen.text(key.name, x + 26, 40, false, "--ink") + 18;
  }
  pen.text(note, x, 40, false, "--quiet");
  let y = HEAD;
  for (const { caption, chart, height } of panels) {
    pen.text(caption, 68, y + 12, false, "--quiet");
    pen.chart(chart, 0, y + CAPTION, WIDTH, height);
    y += CAPTION + height;
  }
}

/** A sheet as PNG. @param {Sheet} sheet @returns {Promise<Blob>} */
export function bitmap(sheet) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [2 * WIDTH, 2 * heightOf(sheet)];
  const context = canvas.getContext("2d");
  if (!context) throw new Error("the browser has no canvas to draw on");
  context.scale(2, 2);
  context.fillStyle = color("--pane");
  context.fillRect(0, 0, WIDTH, heightOf(sheet));
  drawSheet(sheet, {
    text: (text, x, y, bold, ink) => {
      context.font = fontOf(bold);
      context.fillStyle = color(ink);
      context.fillText(text, x, y);
      return context.measureText(text).width;
    },
    key: ({ ink, dash }, x, y) => {
      context.strokeStyle = color(ink);
      context.lineWidth = 3;
      context.setLineDash(dash ? [dash, dash] : []);
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + 20, y);
      context.stroke();
    },
    chart: (chart, x, y, width, height) => context.drawImage(picture(chart, width, height), x, y, width, height),
  });
  return new Promise((resolve, reject) =>
    canvas.toBlob(
      (blob) => (blob ? resolve(blob) : reject(new Error("the browser could not create the picture"))),
      "image/png",
    ),
  );
}

/** @param {boolean} bold */
function fontOf(bold) {
  return `${bold ? "bold 14px" : "12px"} ${font()}`;
}

/** A sheet as SVG. @param {Sheet} sheet */
export function vector(sheet) {
  const measure = document.createElement("canvas").getContext("2d");
  const parts = [`<rect width="100%" height="100%" fill="${color("--pane")}"/>`];
  drawSheet(sheet, {
    text: (text, x, y, bold, ink) => {
      parts.push(
        `<text x="${x}" y="${y}" fill="${color(ink)}" font-family="${escaped(font())}" font-size="${bold ? 14 : 12}"${bold ? ' font-weight="bold"' : ""}>${escaped(text)}</text>`,
      );
      if (measure) measure.font = fontOf(bold);
      return measure?.measureText(text).width ?? text.length * 7;
    },
    key: ({ ink, dash }, x, y) =>
      parts.push(
        `<path d="M${x} ${y}h20" stroke="${color(ink)}" stroke-width="3"${dash ? ` stroke-dasharray="${dash}"` : ""}/>`,
      ),
    chart: (chart, x, y, width, height) => parts.push(drawing(chart, x, y, width, height)),
  });
  const height = heightOf(sheet);
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${WIDTH}" height="${height}" viewBox="0 0 ${WIDTH} ${height}">\n${parts.join("\n")}\n</svg>\n`;
}

/** @param {string} text */
function escaped(text) {
  return text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

/** The motion curves as CSV: one row per column of the picture, with the minimum and maximum of each curve. @param {State} state @param {import("./motion/bands.js").MotionData} columns */
function motionTable(state, columns) {
  // The other axes have other columns.
  const own = { ...columns, others: [] };
  const bands = quantitiesOf(state, own).flatMap((quantity) => {
    const { unit } = chartOf(state, own, quantity);
    return bandsOf(state, own, quantity)
      .reverse()
      .map((band) => ({ ...band, head: `${quantity} ${band.name}`, unit }));
  });
  const cell = (/** @type {number} */ value) => (Number.isFinite(value) ? value : "");
  const head = [
    "time (s)",
    ...bands.flatMap(({ head: name, unit }) => [`${name} min (${unit})`, `${name} max (${unit})`]),
  ];
  return csv([
    head,
    ...[...columns.columns.x].map((seconds, row) => [
      seconds,
      ...bands.flatMap(({ min, max }) => [cell(min[row]), cell(max[row])]),
    ]),
  ]);
}

/** The visible curves of the motion view as CSV. @param {State} state @param {Engine} engine */
export async function motionValues(state, engine) {
  return motionTable(state, await requestMotion(state, engine));
}
