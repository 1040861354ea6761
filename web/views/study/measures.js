/** The tab Measures: figures of the selected axis (see study.js). */

import { element, fill, setText } from "../../dom.js";
import { Dropped } from "../../engine/request_slots.js";
import { errorMessage } from "../../state/error_message.js";
import { isStale } from "../../state/queries.js";
import {
  comparedNote,
  comparedRows,
  distortion,
  durationRows,
  figureRows,
  peakRows,
  sineNote,
  sineRows,
} from "./measure_rows.js";
import { table } from "./table.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createMeasures({ engine, panel }) {
  const about = element("p", { class: "study-note" });
  const rest = element("div");
  /** @param {string} title @param {string} note @param {string[]} head */
  const group = (title, note, head) => {
    const list = table(title, ["measure", ...head.map((text) => `#${text}`), "~meaning"]);
    const root = element(
      "section",
      { class: "measures-group" },
      element("h3", {}, title),
      element("p", { class: "study-note" }, note),
      list.root,
    );
    rest.append(root);
    return { root, note: /** @type {Element} */ (root.children[1]), show: list.show };
  };
  const compared = group("Steps and ticks", "", ["ideal → steps", "steps → pulses", "ideal → pulses"]);
  const duration = group("Duration", "", ["value"]);
  const peaks = group("Peaks of the ideal curve", "", ["value"]);
  const thd = group("Distortion", "", ["ideal", "pulses"]);
  const sine = group("Sine by segments", "", ["sine → segments"]);
  const own = group("Steps", "There is no plan, so the steps of the run or the recording are measured alone.", [
    "value",
  ]);
  fill(panel, about, rest);

  /** @param {import("./measure_rows.js").Measures} measures */
  function show(measures) {
    setText(compared.note, comparedNote(measures));
    compared.show(comparedRows(measures));
    duration.show(durationRows(measures));
    peaks.show(peakRows(measures));
    sine.root.hidden = !measures.sine;
    if (!measures.sine) return;
    setText(sine.note, sineNote(measures.sine));
    sine.show(sineRows(measures.sine));
  }

  /** @param {import("../../state/types.js").Spectra | null} spectra @param {number} axis */
  function showDistortion(spectra, axis) {
    const found = distortion(spectra, axis);
    thd.root.hidden = !found;
    if (!found) return;
    setText(thd.note, found.note);
    thd.show(found.rows);
  }

  /** @param {State} state */
  async function refresh({ result, axis }) {
    if (!result) return;
    const { controller, summary } = result;
    const [found, spectra, steps] = await Promise.all([
      engine.computeForRun("measures", "measures", controller, axis),
      engine.latest("measures-thd", "spectrum"),
      engine.latest("measures-steps", "records_of", axis),
    ])
      .then(async ([found, spectra, run]) => {
        // The slot is the measures' own: a newer question ends this one.
        const figures =
          found === null && (await engine.compute("measures", "step_figures", run, axis, summary.clock_hz));
        return [found, spectra, /** @type {import("./measure_rows.js").Figures | null} */ (figures || null)];
      })
      .catch((error) => {
        if (!(error instanceof Dropped)) {
          // Too many steps to be measured, say.
          rest.hidden = true;
          setText(about, errorMessage(error));
        }
        return [];
      });
    if (found === undefined) return;
    rest.hidden = !found && !steps;
    own.root.hidden = !steps;
    for (const { root } of [compared, duration, peaks, sine]) root.hidden = !found;
    if (steps) {
      setText(about, `Channel ${axis} of the visible run.`);
      own.show(figureRows(steps));
    } else if (found) {
      setText(about, `Axis ${axis} of the visible run.`);
      show(found);
    } else setText(about, `Axis ${axis} has no motion, so there is no curve to compare with.`);
    showDistortion(spectra, axis);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    panel.classList.toggle("stale", isStale(state));
    return before?.result === state.result && before?.axis === state.axis ? undefined : refresh(state);
  }
  return { render };
}
