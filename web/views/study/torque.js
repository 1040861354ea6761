/** The tab Torque: available and needed torque, and ramps with enough torque (see study.js). */
import { button, element, fill, setText } from "../../dom.js";
import { get } from "../../state/paths.js";
import { createJob } from "./job.js";
import { isAnother, selectedAxis } from "./selected_axis.js";
import { motorChoice, selectedSteps } from "./selected_steps.js";
import { table } from "./table.js";
import { createTorqueChart } from "./torque_chart.js";
import { modelNote, motorRows, rampRows, shortageRows, shortageText, stepsText } from "./torque_report.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./torque_report.js").Torque} Torque */

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createTorque({ engine, samples, dispatch, now, panel }) {
  const job = createJob("Torque");
  const about = element("p", { class: "study-note", "aria-live": "polite", tabindex: "-1" });
  const verdict = element("p", { id: "torque-verdict", "aria-live": "polite" });
  const chart = createTorqueChart(() => (body.hidden ? null : torque));
  const facts = table("The motor", ["property", "#value"]);
  const shortages = table("Too little torque", [
    "from",
    "#to",
    "#short of",
    "#at",
    "#rate",
    "~#needed",
    "~#available",
    "~#periods",
  ]);
  const ramps = table("Ramps", [
    "move",
    "#enough torque",
    "#longest ramp for the rate limit",
    "#longest ramp possible",
  ]);
  const rampsTitle = element("h3", {}, "Ramps");
  const note = element("p", { class: "study-note" });
  const body = element(
    "div",
    { class: "study-split" },
    element("div", { class: "study-column" }, chart.root, verdict, shortages.root),
    element("div", { class: "study-column study-side" }, facts.root, rampsTitle, ramps.root, note),
  );
  const motor = motorChoice(engine, () => refresh(now()));
  fill(panel, element("div", { class: "study-bar" }, about, motor.root, job.root), body);
  body.hidden = true;
  /** @type {Torque | null} */
  let torque = null;
  let subjectKey = "";
  /** @param {Torque} found */
  function show(found) {
    torque = found;
    const { report } = found;
    facts.show(motorRows(report));
    const shortage = shortageText(report);
    setText(verdict, shortage || "Enough torque throughout.");
    verdict.classList.toggle("error", shortage !== "");
    shortages.root.hidden = report.total === 0;
    shortages.show(shortageRows(report));
    rampsTitle.hidden = ramps.root.hidden = report.ramps.length === 0;
    ramps.show(rampRows(report));
    setText(note, modelNote(report));
    chart.paint();
  }

  const addMotor = () =>
    button("Add the motor of Song 2021", "Add the motor of Song 2021 to the axis", () => {
      // Another axis may be selected by now.
      const axis = selectedAxis(now());
      if (!axis || typeof axis === "string" || get(now().scenario, `${axis.path}.motor`)) return;
      about.focus({ preventScroll: true });
      dispatch({ type: "edit", path: `${axis.path}.motor`, value: samples.motor });
    });

  /** @param {State} state */
  function refresh(state) {
    const axis = selectedAxis(state);
    panel.classList.toggle("stale", axis === "");
    if (!axis) return;
    const listed = typeof axis === "string" && !state.scenario.source?.motion;
    motor.show(listed && !state.scenario.plant);
    if (listed) return refreshSteps(state);
    if (typeof axis === "string") {
      subjectKey = "";
      body.hidden = true;
      return setText(about, axis);
    }
    const next = JSON.stringify([axis.json, axis.controller, axis.axis]);
    if (next === subjectKey) return;
    subjectKey = next;
    job.run(
      () => engine.compute("torque", "torque", axis.json, axis.controller, axis.axis),
      (/** @type {Torque | undefined} */ found) => {
        torque = null;
        body.hidden = !found;
        if (!found)
          return fill(
            about,
            `Axis ${axis.axis} has no motor. Add one in the form, under the mechanics of the axis. `,
            addMotor(),
          );
        setText(
          about,
          `Axis ${axis.axis}: available torque and torque needed by the plan. The form has the motor data.`,
        );
        return show(found);
      },
    );
  }

  /** The torque that the steps of a channel without a plan need. @param {State} state */
  function refreshSteps(state) {
    const steps = selectedSteps(state);
    panel.classList.toggle("stale", steps === null);
    if (!steps) return;
    const { json, revision, controller, channel } = steps;
    const motorId = motor.value();
    const next = JSON.stringify([revision, controller, channel, motorId]);
    if (next === subjectKey) return;
    subjectKey = next;
    if (!state.scenario.plant && motorId === "") {
      body.hidden = true;
      setText(about, "There is no motor: select one for these steps, or simulate one in the view Motor.");
      return;
    }
    job.run(
      async () => {
        const run = await engine.request("records_of", channel);
        return engine.compute("torque", "torque_of_steps", json, controller, channel, run, motorId);
      },
      (/** @type {Torque | undefined} */ found) => {
        torque = null;
        body.hidden = !found;
        if (!found) return;
        setText(about, stepsText(channel, motorId, found.report));
        show(found);
      },
    );
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (isAnother(state, before)) refresh(state);
    if (before?.view !== state.view || before?.study !== state.study) chart.paint();
  }
  return { render };
}
