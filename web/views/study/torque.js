/**
 * The tab Torque of the study: the torque that the selected axis' motor has at each rate, what the plan needs of it, where that is
 * too much, and which ramps leave enough; where no plan is known, what the steps need. What a tab is, says study.js.
 */
import { button, element, fill, say } from "../../dom.js";
import { count, plain, short, si } from "../../state/number.js";
import { get } from "../../state/paths.js";
import { color, draw, watch } from "../../time/plot.js";
import { createJob, table } from "./parts.js";
import { isAnother, selectedAxis } from "./selected_axis.js";
import { motorChoice, selectedSteps } from "./selected_steps.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{at_s: number, rate: number, needed_mn_m: number, available_mn_m: number}} Moment */
/** @typedef {{index: number, duration_s: number, longest_s: number | null, too_fast: boolean, room_s: number, enough_s: [number, number] | null,
 *   too_fast_s: [number, number] | null, without_ramps: boolean}} Ramps */
/**
 * @typedef {{standing_mn_m: number, load_mn_m: number, corner_rate: number | null, torque_rate: number | null, working_rate: number | null,
 *   over_working_rate: number | null, jump: number, least: Moment | null, total: number, window_s: number | null,
 *   shortages: {from_s: number, to_s: number, times: number, worst: Moment}[], ramps: Ramps[]}} Report
 * @typedef {{report: Report, rate: Float64Array, available: Float64Array, needed: Float64Array}} Torque
 */

/** @param {number} torque In mN·m. */
const torques = (torque) => `${short(torque, 4)} mN·m`;
/** @param {number} rate */
const rates = (rate) => plain(rate, "steps/s");
/** @param {number | null} rate */
const upTo = (rate) => (rate === null ? "any rate" : rate === 0 ? "no rate" : rates(Math.floor(rate)));
/** @param {number} seconds */
const ramp = (seconds) => `${seconds.toFixed(4)} s`;
/** What limits where no ramp is enough: the stated rate or the torque. @param {Ramps} ramps */
function enough({ enough_s, too_fast_s, without_ramps }) {
  if (enough_s) return `${enough_s[0].toFixed(4)} to ${ramp(enough_s[1])}`;
  const all = too_fast_s ? "all above the working rate" : "none";
  return without_ramps ? `without ramps only; with ramps ${all}` : all;
}

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createTorque({ engine, samples, dispatch, now, panel }) {
  const job = createJob("Torque");
  const about = element("p", { class: "study-note", "aria-live": "polite", tabindex: "-1" });
  const verdict = element("p", { id: "torque-verdict", "aria-live": "polite" });
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
  const chart = element("div", { class: "chart torque-chart" }, caption, canvas);
  const facts = table("The motor", ["of the motor", "#value"]);
  const lacks = table("Too little torque", [
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
  const ramped = element("h3", {}, "Ramps");
  const note = element("p", { class: "study-note" });
  const body = element(
    "div",
    { class: "study-split" },
    element("div", { class: "study-column" }, chart, verdict, lacks.root),
    element("div", { class: "study-column study-side" }, facts.root, ramped, ramps.root, note),
  );
  const motor = motorChoice(engine, () => refresh(now()));
  fill(panel, element("div", { class: "study-bar" }, about, motor.root, job.root), body);
  body.hidden = true;
  /** @type {Torque | null} */
  let torque = null;
  let asked = "";
  watch(chart, paint);

  function paint() {
    if (!torque || body.hidden) return;
    const {
      rate,
      available,
      needed,
      report: { working_rate: working },
    } = torque;
    stated.hidden = working === null;
    const most = Math.max(...available, ...needed.filter((torque) => !Number.isNaN(torque)));
    draw(canvas, {
      x: { min: 0, max: rate[rate.length - 1], unit: "steps/s", prefix: true, label_px: 20 },
      y: { min: 0, max: 1.08 * most, unit: "", prefix: false, label_px: 58 },
      series: [
        { color: color("--actual"), opacity: 0.75, width: 2, x: rate, shape: { stems: { y: needed, shift: 0 } } },
        {
          color: color("--ideal"),
          opacity: 1,
          width: 2,
          x: rate,
          shape: { line: { y: available.map((torque) => Math.max(torque, 0)) } },
        },
        ...(working === null
          ? []
          : [
              {
                color: color("--axis"),
                opacity: 1,
                width: 1.5,
                dash: 4,
                x: [working, working],
                shape: { line: { y: [0, 2 * most] } },
              },
            ]),
      ],
    });
  }

  /** @param {Report} report */
  function show(report) {
    const { least, jump, total, shortages, over_working_rate, working_rate } = report;
    facts.show([
      ...(report.corner_rate === 0
        ? [
            ["Torque at standstill", torques(report.standing_mn_m)],
            ["full current up to", "no rate: the supply is too low"],
          ]
        : [
            ["Full torque", torques(report.standing_mn_m)],
            ["full torque up to", upTo(report.corner_rate)],
          ]),
      ["Load", torques(report.load_mn_m)],
      ["torque for it up to", upTo(report.torque_rate)],
      ...(working_rate === null ? [] : [["Stated working rate", rates(working_rate)]]),
      ...(least
        ? [
            ["Least margin", torques(least.available_mn_m - Math.abs(least.needed_mn_m))],
            ["at", `${si(least.at_s, "s")}, ${rates(least.rate)}`],
          ]
        : []),
      ...(jump > 0 ? [["Greatest jump of speed", rates(jump)]] : []),
    ]);
    const fast =
      over_working_rate === null
        ? ""
        : `⚠ ${rates(over_working_rate)} are above the stated working rate: give more time, or shorter ramps. `;
    const lack =
      total === 0
        ? ""
        : `⚠ Too little torque in ${total === 1 ? "one interval" : `${count(total)} intervals`}: give more time, gentler ramps, less load or a higher supply voltage.`;
    say(verdict, fast + lack || "Enough torque throughout.");
    verdict.classList.toggle("error", fast + lack !== "");
    lacks.root.hidden = total === 0;
    lacks.show(
      shortages.map(({ from_s, to_s, times, worst: { at_s, rate, needed_mn_m, available_mn_m } }) => [
        si(from_s, "s"),
        si(to_s, "s"),
        torques(Math.abs(needed_mn_m) - available_mn_m),
        si(at_s, "s"),
        rates(rate),
        torques(needed_mn_m),
        torques(available_mn_m),
        count(times),
      ]),
    );
    ramped.hidden = ramps.root.hidden = report.ramps.length === 0;
    ramps.show(
      report.ramps.map((found) => [
        `${found.index + 1}, ${si(found.duration_s, "s")}`,
        enough(found),
        found.longest_s === null ? (found.too_fast ? "too fast" : "any") : ramp(found.longest_s),
        ramp(found.room_s),
      ]),
    );
    say(
      note,
      `${report.window_s === null ? "" : `The acceleration of steps is taken over the rotor's natural period, ${si(report.window_s, "s")}: what comes and goes faster moves it little. `}${report.ramps.length ? "Enough torque: ramps with which it suffices throughout. Longest ramp for the rate limit: T − n/f_s (for ramps of area 1/2), with the motor's greatest rate for its load as f_s; the longest ramp possible is T/2. " : ""}${jump > 0 ? "A motor follows a jump of speed up to its start-stop rate, which these data do not tell. " : ""}The model: fundamental waves only, no saturation, no losses of iron and friction in the motor, no resonance.`,
    );
  }

  const add = () =>
    button("Add the document's motor", "Add the document's motor: Song, Han and Lu 2021", () => {
      // What is looked at by now; the button goes with the answer.
      const of = selectedAxis(now());
      if (!of || typeof of === "string" || get(now().scenario, `${of.path}.motor`)) return;
      about.focus({ preventScroll: true });
      dispatch({ type: "edit", path: `${of.path}.motor`, value: samples.motor });
    });

  /** @param {State} state */
  function refresh(state) {
    const of = selectedAxis(state);
    panel.classList.toggle("stale", of === "");
    if (!of) return;
    const listed = typeof of === "string" && !state.scenario.source?.motion;
    motor.show(listed && !state.scenario.plant);
    if (listed) return ofSteps(state);
    if (typeof of === "string") {
      asked = "";
      body.hidden = true;
      return say(about, of);
    }
    const next = JSON.stringify([of.json, of.controller, of.axis]);
    if (next === asked) return;
    asked = next;
    job.run(
      () => engine.consider("torque", "torque", of.json, of.controller, of.axis),
      (/** @type {Torque | undefined} */ answer) => {
        torque = answer ?? null;
        body.hidden = torque === null;
        if (!torque)
          return fill(
            about,
            `Axis ${of.axis} has no motor yet: the form has its data under the axis' mechanics. `,
            add(),
          );
        say(about, `Axis ${of.axis}: what its motor has, and what its plan needs. Its data are in the form.`);
        show(torque.report);
        paint();
      },
    );
  }

  /** Of a channel without a plan: what its steps ask for. @param {State} state */
  function ofSteps(state) {
    const of = selectedSteps(state);
    panel.classList.toggle("stale", of === null);
    if (!of) return;
    const { json, revision, controller, channel } = of;
    const named = motor.value();
    const next = JSON.stringify([revision, controller, channel, named]);
    if (next === asked) return;
    asked = next;
    if (!state.scenario.plant && named === "") {
      body.hidden = true;
      say(about, "No motor is driven here: choose one to judge the steps for, or drive one in the view Motor.");
      return;
    }
    const which = named === "" ? "its motor" : "this motor at 16 microsteps, on 24 V without a load,";
    job.run(
      async () => {
        const run = await engine.ask("records_of", channel);
        return engine.consider("torque", "torque_of_steps", json, controller, channel, run, named);
      },
      (/** @type {Torque | undefined} */ answer) => {
        torque = answer ?? null;
        body.hidden = torque === null;
        if (!torque) return;
        say(
          about,
          torque.report.least
            ? `Channel ${channel}: what ${which} has, and what the steps need; no plan is known.`
            : `Channel ${channel} makes no step, so nothing is asked of its motor.`,
        );
        show(torque.report);
        paint();
      },
    );
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (isAnother(state, before)) refresh(state);
    if (before?.view !== state.view || before?.study !== state.study) paint();
  }
  return { render };
}
