/** The tab Motor: limits, resonance and supply current of a motor (see study.js). */
import { button, element, fill, setText } from "../../dom.js";
import { createJob } from "./job.js";
import { createMotorCharts } from "./motor_charts.js";
import {
  joinedMap,
  limitRows,
  MAP,
  MAP_RATES,
  noFindings,
  pairPieces,
  pairText,
  resonancePieces,
  settleEdit,
  settlingText,
  subjectOf,
  subjectText,
  whyNoPair,
} from "./motor_findings.js";
import { field } from "./parts.js";
import { isAnother } from "./selected_axis.js";
import { table } from "./table.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./motor_findings.js").Subject} Subject */

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createMotorTab({ engine, dispatch, now, panel }) {
  const about = element("p", { class: "study-note", "aria-live": "polite" });
  const ramp = field("Ramp", "steps/s²", 200_000, { min: 1000, max: 1e9 }, () => refresh(now(), true));
  const limitsJob = createJob("Rates");
  const resonanceJob = createJob("Resonance");
  const stepJob = createJob("Supply current of one step");
  const pairJob = createJob("Supply current of the run");
  const findings = noFindings();
  const charts = createMotorCharts(() => (body.hidden ? null : findings));
  const limits = table("Motor limits", ["limit", "#value"]);
  const settled = element("p", { class: "study-note" });
  const pair = element("p", { class: "study-note" });
  const useSettling = button("Use as settling time", "Use as settling time of the driver bus", applySettling, true);
  const body = element(
    "div",
    { class: "study-split" },
    element("div", { class: "study-column" }, charts.torque, charts.map, charts.pair),
    element(
      "div",
      { class: "study-column study-side" },
      limits.root,
      limitsJob.root,
      resonanceJob.root,
      charts.step,
      settled,
      useSettling,
      stepJob.root,
      pair,
      pairJob.root,
    ),
  );
  fill(panel, element("div", { class: "study-bar" }, about, ramp.root), body);
  body.hidden = ramp.root.hidden = true;
  /** The motor of the findings; `subjectKey` identifies it. @type {Subject | null} */
  let subject = null;
  let subjectKey = "";

  /** @param {Partial<typeof findings>} found */
  function show(found) {
    Object.assign(findings, found);
    charts.paint();
    if (findings.pair) setText(pair, pairText(findings.pair));
  }

  /** @param {Partial<typeof findings>} found */
  function showLimits(found) {
    show(found);
    limits.show(limitRows(findings));
  }

  function applySettling() {
    const edit = settleEdit(findings, subject?.controller ?? 0);
    if (edit) dispatch({ type: "edit", ...edit });
  }

  /** @param {State} state @param {boolean} [isOtherRamp] */
  function refresh(state, isOtherRamp = false) {
    const { validation, validated, revision } = state;
    if (validated !== revision || !validation) return;
    panel.classList.toggle("stale", validation.problems.length > 0);
    if (validation.problems.length > 0) return;
    body.hidden = ramp.root.hidden = !state.scenario.plant;
    if (!state.scenario.plant) {
      subjectKey = "";
      return setText(about, "There is no motor: select one in the view Motor, or under Motors and supply in the form.");
    }
    const next = subjectOf(state);
    if (!next) return;
    subject = next;
    setText(about, subjectText(next));
    const key = JSON.stringify([next.json, next.controller, next.channel]);
    if (key !== subjectKey) {
      subjectKey = key;
      clear();
      findResonance(next);
      findSettling(next);
    } else if (!isOtherRamp) return;
    findLimits(next);
  }

  function clear() {
    limits.show([]);
    for (const text of [settled, pair]) setText(text, "");
    useSettling.disabled = true;
    show(noFindings());
  }

  /** @param {Subject} subject */
  function findLimits({ json, controller, channel }) {
    limitsJob.run(async (signal, report) => {
      report(0, "start-stop and pull-out rate");
      const requestOne = (/** @type {string} */ method, /** @type {any[]} */ ...args) =>
        engine.distribute(method, [[json, controller, channel, ...args]], signal).then(([answer]) => answer);
      const [start, pull] = await Promise.all([requestOne("start_stop"), requestOne("pull_out", ramp.value())]);
      const torque = await requestOne("torque_of_motor", 1.1 * Math.max(start ?? 0, pull ?? 0, 1000));
      return { start, pull, torque };
    }, showLimits);
  }

  /** @param {Subject} subject */
  function findResonance(subject) {
    const pieces = resonancePieces(subject);
    resonanceJob.run(
      async (signal, report) => {
        let done = 0;
        report(0, `resonance: 0 of ${MAP_RATES} rates`);
        return engine.distribute("resonance", pieces, signal, () => {
          done += 1;
          report(done / pieces.length, `resonance: ${Math.min(MAP_RATES, done * MAP.piece)} of ${MAP_RATES} rates`);
        });
      },
      (answers) => showLimits(joinedMap(answers)),
    );
  }

  /** The supply current of one step, and then of the run. @param {Subject} subject */
  function findSettling(subject) {
    stepJob.run(
      async (signal, report) => {
        report(0, "supply current of one step");
        return engine.distribute("settling", [[subject.json, subject.controller, subject.channel]], signal);
      },
      ([step]) => {
        setText(settled, settlingText(step, now().result?.summary.clock_hz ?? 1));
        useSettling.disabled = step.reached_cycles === null;
        show({ step });
        findPair(subject, step.reached_cycles ?? step.slot_cycles);
      },
    );
  }

  /** The supply current of the run with simultaneous and with staggered pulses. @param {Subject} subject @param {number} settle_cycles  The measured time. */
  function findPair(subject, settle_cycles) {
    const why = whyNoPair(now(), subject.channels);
    setText(pair, why);
    if (why)
      return pairJob.run(
        async () => null,
        () => {},
      );
    return pairJob.run(
      async (signal, report) => {
        report(0, "supply current of the run, simultaneous and staggered");
        return engine.distribute("supply_current", pairPieces(subject, settle_cycles), signal);
      },
      (answer) => show({ pair: /** @type {typeof findings.pair} */ (answer) }),
    );
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (isAnother(state, before)) refresh(state);
    if (before?.view !== state.view || before?.study !== state.study) charts.paint();
  }
  return { render };
}
