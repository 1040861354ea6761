/** The best vertices for a number of segments, and the move through them. */
import { button, element, fill } from "../../dom.js";
import { maxLengthOf } from "../../form/schema.js";
import { count, counted, short } from "../../state/number.js";
import { createJob } from "./job.js";
import { field } from "./parts.js";
import { table } from "./table.js";

/** @typedef {{angle_deg: Float64Array, height: Float64Array, thd: number}} Vertices  Of a quarter, from the extreme to the middle. */
/** @typedef {{amplitude: {[unit: string]: number}, period_s: number, periods: number}} Sine  As a scenario has it. */

/** Digits of a time or a position: enough for any cycle. */
const DIGITS = 12;

/**
 * @param {{engine: import("../../engine/engine.js").Engine, order: () => number, putMove: (make: (sine: Sine) => object | string) => void}} page
 *   `order` is the highest harmonic of the distortion; `putMove` replaces the scenario's sine.
 */
export function createVertices({ engine, order, putMove }) {
  const segments = field("segments per quarter", "", 6, { min: 1, max: 32, integer: true }, find);
  const job = createJob("Vertices");
  const note = element("p", { class: "study-note", id: "sine-vertices" });
  const list = table("Best vertices", ["vertex", "#on the curve", "#height", "#free", "#height"]);
  const parts = [
    element("h3", {}, "Best vertices"),
    element("div", { class: "study-bar" }, segments.root, job.root),
    note,
    list.root,
  ];

  /** Finds the best vertices, on the curve and free. */
  function find() {
    const number = segments.value();
    job.run(
      (signal, report) => {
        report(0, counted(number, "segment"));
        const requests = [false, true].map((free) => [number, free, order()]);
        return engine.distribute("sine_vertices", requests, signal);
      },
      (/** @type {Vertices[]} */ [onCurve, free]) => {
        const use = (/** @type {Vertices} */ vertices, /** @type {string} */ name) =>
          button("Use", `Use: ${counted(number, "segment")}, vertices ${name}`, () =>
            putMove((sine) => through(vertices, sine)),
          );
        fill(
          note,
          `Minimum THD of position with ${counted(number, "segment")}: ${percent(onCurve.thd)} with vertices on the curve `,
          use(onCurve, "on the curve"),
          `, ${percent(free.thd)} with free ones `,
          use(free, "free"),
          ".",
        );
        list.show(
          Array.from(onCurve.angle_deg, (_, i) => [
            String(i),
            ...[onCurve, free].flatMap(({ angle_deg, height }) => [
              `${angle_deg[i].toFixed(3)}°`,
              height[i].toFixed(5),
            ]),
          ]),
        );
      },
    );
  }

  return { parts, find };
}

/** The move through the vertices for all periods of a sine; a text says why there is none. @param {Vertices} vertices @param {Sine} sine */
function through({ angle_deg, height }, { amplitude, period_s, periods }) {
  const [[unit, size]] = Object.entries(amplitude);
  const maxPoints = maxLengthOf("Points", "points");
  const quarter = angle_deg.length - 1;
  if (4 * quarter * periods + 1 > maxPoints)
    return `${counted(periods, "period")} of ${count(4 * quarter)} vertices exceed the ${count(maxPoints)} points of a move; use at most ${count(Math.floor((maxPoints - 1) / (4 * quarter)))} periods.`;
  const half = [...angle_deg.keys()].map((i) => [angle_deg[i], height[i]]);
  const down = [
    ...half,
    ...half
      .slice(0, -1)
      .reverse()
      .map(([angle, level]) => [180 - angle, -level]),
  ];
  const period = [
    ...down,
    ...down
      .slice(0, -1)
      .reverse()
      .map(([angle, level]) => [360 - angle, level]),
  ];
  const digits = (/** @type {number} */ value) => Number(value.toPrecision(DIGITS));
  const points = Array.from({ length: periods }, (_, turn) =>
    period
      .slice(turn === 0 ? 0 : 1)
      .map(([angle, level]) => [digits((turn + angle / 360) * period_s), digits(size * (level - height[0]))]),
  ).flat();
  return { points: { unit, interpolation: "straight", points } };
}

/** @param {number} ratio */
const percent = (ratio) => `${short(100 * ratio, 4)} %`;
