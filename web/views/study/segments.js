/** The table of segments of the current sine. */
import { element, setText } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, plain, si } from "../../state/number.js";
import { table } from "./table.js";

/** @typedef {{from_deg: Float64Array, to_deg: Float64Array, steps: Float64Array, rate: Float64Array, duration_s: Float64Array, segment_bytes: number, interval_bytes: number}} Segments */

/** @param {{engine: import("../../engine/engine.js").Engine}} page */
export function createSegments({ engine }) {
  const list = table("Segments of the current sine", ["from", "#to", "#steps", "#rate, steps/s", "~#time"]);
  const note = element("p", { class: "study-note" });
  const root = element("div", {}, element("h3", {}, "Current segments"), note, list.root);
  root.hidden = true;
  let axisKey = "";

  /** @param {import("./selected_axis.js").SelectedAxis | null} axis */
  async function show(axis) {
    const key = axis ? `${axis.controller} ${axis.axis} ${axis.json}` : "";
    if (key === axisKey) return;
    axisKey = key;
    /** @type {Segments | null | undefined} */
    const segments = axis
      ? await engine.compute("segments", "sine_segments", axis.json, axis.controller, axis.axis).catch(unlessDropped)
      : null;
    if (key !== axisKey) return;
    root.hidden = !segments;
    if (!segments) return;
    setText(
      note,
      `One quarter; the others are symmetric. It takes ${count(segments.segment_bytes)} bytes, or ${count(segments.interval_bytes)} with one interval per step.`,
    );
    list.show(
      Array.from(segments.steps, (steps, i) => [
        `${segments.from_deg[i].toFixed(3)}°`,
        `${segments.to_deg[i].toFixed(3)}°`,
        count(steps),
        plain(segments.rate[i], ""),
        si(segments.duration_s[i], "s"),
      ]),
    );
  }
  return { root, show };
}
