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

  /** @param {import("./selected_axis.js").SelectedAxis | null} of */
  async function show(of) {
    const key = of ? `${of.controller} ${of.axis} ${of.json}` : "";
    if (key === axisKey) return;
    axisKey = key;
    /** @type {Segments | null | undefined} */
    const made = of
      ? await engine.compute("segments", "sine_segments", of.json, of.controller, of.axis).catch(unlessDropped)
      : null;
    if (key !== axisKey) return;
    root.hidden = !made;
    if (!made) return;
    setText(
      note,
      `One quarter; the others are symmetric. It takes ${count(made.segment_bytes)} bytes, or ${count(made.interval_bytes)} with one interval per step.`,
    );
    list.show(
      Array.from(made.steps, (steps, i) => [
        `${made.from_deg[i].toFixed(3)}°`,
        `${made.to_deg[i].toFixed(3)}°`,
        count(steps),
        plain(made.rate[i], ""),
        si(made.duration_s[i], "s"),
      ]),
    );
  }
  return { root, show };
}
