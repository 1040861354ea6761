/** Exports the motor view as picture and table. */
import { unlessDropped } from "../../engine/engine.js";
import { csv } from "../../shell/tables.js";
import { time } from "../../state/number.js";
import { shown } from "../../state/time_window.js";
import { channelOf, chartOf, marksOf, visibleQuantities } from "./quantities.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("../../engine/engine.js").Engine} Engine */

/** Height of a chart, and of the time labels below the last one, in CSS pixels. */
const [PANEL, TIME_PX] = [150, 20];

/** @param {State} state @param {Engine} engine @param {number} columns */
async function requestCurves(state, engine, columns) {
  const { start, end } = shown(state);
  const channel = channelOf(state);
  const [report, curves] = await Promise.all([
    engine.request("plant"),
    engine.latest("motor file", "plant_curves", channel, start, end, columns).catch(unlessDropped),
  ]);
  if (!curves || !report) throw new Error("no motor is simulated, so there is nothing to save");
  const clock = state.result?.summary.clock_hz ?? 1;
  return {
    curves,
    channel,
    from: start / clock,
    to: end / clock,
    marks: marksOf(report, channel, { start, end }, clock),
  };
}

/** @param {State} state @param {Engine} engine @param {number} columns  Of the picture. @returns {Promise<{about: string, legend: {name: string, ink: string, dash: number}[], panels: {caption: string, chart: import("../../time/plot.js").Chart, height: number}[]}>} */
export async function motorPanels(state, engine, columns) {
  const { curves, channel, from, to, marks } = await requestCurves(state, engine, columns);
  const all = visibleQuantities(state);
  return {
    about: `motor ${channel} · ${time(from)} to ${time(to)}`,
    legend: [],
    panels: all.map((quantity, at) => {
      const isLast = at === all.length - 1;
      const names = quantity.lines.map(({ label, dash }) => (dash ? `${label} (dashed)` : label)).join(", ");
      return {
        caption: `${quantity.title.toLowerCase()}, ${quantity.unit}: ${names}`,
        chart: chartOf(quantity, curves, { from, to, marks }, isLast).chart,
        height: PANEL + (isLast ? TIME_PX : 0),
      };
    }),
  };
}

/** The visible curves as CSV, with the minimum and maximum of each column. @param {State} state @param {Engine} engine @param {number} columns */
export async function motorValues(state, engine, columns) {
  const { curves } = await requestCurves(state, engine, columns);
  const lines = visibleQuantities(state).flatMap(({ unit, lines }) => lines.map(({ of }) => ({ of, unit })));
  const head = ["time (s)", ...lines.flatMap(({ of, unit }) => [`${of} min (${unit})`, `${of} max (${unit})`])];
  const { x } = curves[lines[0].of];
  return csv([
    head,
    ...Array.from(x, (seconds, row) => [
      seconds,
      ...lines.flatMap(({ of }) => [curves[of].min[row], curves[of].max[row]]),
    ]),
  ]);
}
