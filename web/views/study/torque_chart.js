/** The torque-speed curve: available and needed torque, and the stated working rate. */
import { element } from "../../dom.js";
import { color, draw, watch } from "../../time/plot.js";

/** @param {() => import("./torque_report.js").Torque | null} shown  Null if the chart is hidden. */
export function createTorqueChart(shown) {
  const canvas = element("canvas", { role: "img", "aria-label": "Torque-speed curve" });
  const key = (/** @type {string} */ kind, /** @type {string} */ text) =>
    element("span", {}, element("span", { class: `key ${kind}` }), ` ${text} `);
  const stated = element("span", {}, "; dashed: the stated working rate");
  const caption = element(
    "div",
    { class: "caption" },
    element("span", {}, "Torque-speed curve, mN·m over steps/s: "),
    key("ideal", "available"),
    key("actual", "needed, driving or braking"),
    stated,
  );
  const root = element("div", { class: "chart torque-chart" }, caption, canvas);
  watch(root, paint);

  function paint() {
    const torque = shown();
    if (!torque) return;
    const { rate, available, needed, report } = torque;
    const { working_rate: working } = report;
    stated.hidden = working === null;
    const maxTorque = Math.max(...available, ...needed.filter((torque) => !Number.isNaN(torque)));
    const line = { opacity: 1, width: 2, x: rate };
    const positive = available.map((torque) => Math.max(torque, 0));
    draw(canvas, {
      x: { min: 0, max: rate[rate.length - 1], unit: "steps/s", prefix: true, label_px: 20 },
      y: { min: 0, max: 1.08 * maxTorque, unit: "", prefix: false, label_px: 58 },
      series: [
        { ...line, color: color("--actual"), opacity: 0.75, shape: { stems: { y: needed, shift: 0 } } },
        { ...line, color: color("--ideal"), shape: { line: { y: positive } } },
        ...(working === null ? [] : [workingLine(working, 2 * maxTorque)]),
      ],
    });
  }
  return { root, paint };
}

/** @param {number} rate @param {number} top */
const workingLine = (rate, top) => ({
  color: color("--axis"),
  opacity: 1,
  width: 1.5,
  dash: 4,
  x: [rate, rate],
  shape: { line: { y: [0, top] } },
});
