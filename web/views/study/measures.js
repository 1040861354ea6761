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
  const groups = element("div");
  /** @param {string} title @param {string} note @param {string[]} head */
  const addGroup = (title, note, head) => {
    const list = table(title, ["measure", ...head.map((text) => `#${text}`), "~meaning"]);
    const root = element(
      "section",
      { class: "measures-group" },
      element("h3", {}, title),
      element("p", { class: "study-note" }, note),
      list.root,
    );
    groups.append(root);
    return { root, note: /** @type {Element} */ (root.children[1]), show: list.show };
  };
  const compared = addGroup("Steps and ticks", "", ["ideal → steps", "steps → actual", "ideal → actual"]);
  const duration = addGroup("Duration", "", ["value"]);
  const peaks = addGroup("Maxima of the ideal curve", "", ["value"]);
  const thd = addGroup("Distortion", "", ["ideal", "actual"]);
  const sine = addGroup("Sine by segments", "", ["sine → segments"]);
  const own = addGroup("Steps", "There is no plan: only the steps of the run or the recording are measured.", [
    "value",
  ]);
  fill(panel, about, groups);

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
    const measures = distortion(spectra, axis);
    thd.root.hidden = !measures;
    if (!measures) return;
    setText(thd.note, measures.note);
    thd.show(measures.rows);
  }

  /** @param {State} state */
  async function refresh({ result, axis }) {
    if (!result) return;
    const { controller, summary } = result;
    const [measures, spectra, steps] = await Promise.all([
      engine.computeForRun("measures", "measures", controller, axis),
      engine.latest("measures-thd", "spectrum"),
      engine.latest("measures-steps", "records_of", axis),
    ])
      .then(async ([measures, spectra, run]) => {
        // Only the measures use this slot: a newer request ends this one.
        const figures =
          measures === null && (await engine.compute("measures", "step_figures", run, axis, summary.clock_hz));
        return [measures, spectra, /** @type {import("./measure_rows.js").Figures | null} */ (figures || null)];
      })
      .catch((error) => {
        if (!(error instanceof Dropped)) {
          // For example, too many steps.
          groups.hidden = true;
          setText(about, errorMessage(error));
        }
        return [];
      });
    if (measures === undefined) return;
    groups.hidden = !measures && !steps;
    own.root.hidden = !steps;
    for (const { root } of [compared, duration, peaks, sine]) root.hidden = !measures;
    if (steps) {
      setText(about, `Channel ${axis} of the visible run.`);
      own.show(figureRows(steps));
    } else if (measures) {
      setText(about, `Axis ${axis} of the visible run.`);
      show(measures);
    } else setText(about, `Axis ${axis} has no motion, so there is no curve for a comparison.`);
    showDistortion(spectra, axis);
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    panel.classList.toggle("stale", isStale(state));
    return before?.result === state.result && before?.axis === state.axis ? undefined : refresh(state);
  }
  return { render };
}
