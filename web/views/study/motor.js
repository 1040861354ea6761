/**
 * The tab Motor of the study: what a motor of the plant can do, at once and by a ramp; where it resonates; and what its steps
 * do to the supply (the patent's figures 1 and 2). What a tab is, says study.js.
 */
import { button, element, fill, say } from "../../dom.js";
import { runsAlone } from "../../form/sources.js";
import { readJson } from "../../state/json.js";
import { plain, short, si } from "../../state/number.js";
import { get, set } from "../../state/paths.js";
import { color, draw, GUTTER, watch } from "../../time/plot.js";
import { shapeOf, swatch } from "../lines.js";
import { createJob, field, table } from "./parts.js";
import { isAnother } from "./selected_axis.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {{rate: Float64Array, available: Float64Array, needed: Float64Array}} Torque */
/** @typedef {{rest_a: number, least_a: number, greatest_a: number, reached_cycles: number | null, settled_cycles: number | null, slot_cycles: number, x: Float64Array, y: Float64Array}} Settling */
/** @typedef {{x: Float64Array, min: Float64Array, max: Float64Array, above_a: number | null, below_a: number | null}} Supply */

/** Rates of the resonance map in full steps/s, and those of one piece of the work. */
const MAP = { from: 20, to: 400, rung: 4, piece: 8 };
/** What still counts as settled. */
const SHARE = 0.2;
/** Columns of the supply current. */
const COLUMNS = 1200;

const AXIS = { unit: "", prefix: true, label_px: GUTTER };

/** What is found of a motor, before it is. @returns {{torque: Torque | null, start: number | undefined, pull: number | undefined, swing: Float64Array, loses: Float64Array, step: Settling | null, pair: [Supply, Supply] | null}} */
const nothing = () => ({
  torque: null,
  start: undefined,
  pull: undefined,
  swing: new Float64Array(),
  loses: new Float64Array(),
  step: null,
  pair: null,
});

/** @param {string} text @param {string} label */
function chart(text, label) {
  const canvas = element("canvas", { role: "img", "aria-label": label });
  const keys = element("span");
  const root = element(
    "div",
    { class: "chart torque-chart" },
    element("div", { class: "caption" }, element("span", {}, text), keys),
    canvas,
  );
  return { root, canvas, keys };
}

/** A line of a chart. @param {string} ink @param {ArrayLike<number>} x @param {ArrayLike<number>} y @param {{width?: number, dash?: number}} [look] */
const line = (ink, x, y, { width = 1.8, dash = 0 } = {}) => ({
  color: color(ink),
  opacity: 1,
  width,
  dash,
  x: Float64Array.from(x),
  shape: { line: { y } },
});

/** Least and greatest of some values with air around them. @param {ArrayLike<number>[]} all */
function around(all) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of all)
    for (const value of Array.from(values))
      if (!Number.isNaN(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
  if (low > high) [low, high] = [0, 1];
  const air = 0.08 * (high - low) || 1;
  return { min: low - air, max: high + air };
}

/** @param {string} ink @param {string} text @param {boolean} [dashed] */
const key = (ink, text, dashed = false) => element("span", {}, swatch(ink, dashed), ` ${text} `);

/** @param {import("./study.js").StudyPage} page @returns {import("./study.js").StudyTab} */
export function createMotorTab({ engine, dispatch, now, panel }) {
  const about = element("p", { class: "study-note", "aria-live": "polite" });
  const ramp = field("Ramp", "steps/s²", 200_000, { least: 1000, most: 1e9 }, () => refresh(now(), true));
  const [rates, map, step, both] = [
    createJob("Rates"),
    createJob("Resonance"),
    createJob("Supply current of one step"),
    createJob("Supply current of the run"),
  ];
  const torqueChart = chart("Torque over rate, mN·m over steps/s: ", "Torque over rate");
  const mapChart = chart("Swing at each rate, full steps over full steps/s: ", "Resonance");
  const stepChart = chart("Supply current of one step behind the sensor, A over s: ", "Supply current of one step");
  const pairChart = chart("Supply current of the run behind the sensor, A over s: ", "Supply current of the run");
  const facts = table("What the motor can do", ["of the motor", "#value"]);
  const settled = element("p", { class: "study-note" });
  const pair = element("p", { class: "study-note" });
  const press = button("Take as settling time", "Take as settling time of the driver bus", take, true);
  const body = element(
    "div",
    { class: "study-split" },
    element("div", { class: "study-column" }, torqueChart.root, mapChart.root, pairChart.root),
    element(
      "div",
      { class: "study-column study-side" },
      facts.root,
      rates.root,
      map.root,
      stepChart.root,
      settled,
      press,
      step.root,
      pair,
      both.root,
    ),
  );
  fill(panel, element("div", { class: "study-bar" }, about, ramp.root), body);
  body.hidden = ramp.root.hidden = true;

  const found = nothing();
  let asked = "";
  let json = "";
  /** The controller that all is about. */
  let controller = 0;
  for (const each of [torqueChart, mapChart, stepChart, pairChart]) watch(each.root, paint);

  function paint() {
    if (body.hidden) return;
    paintTorque();
    paintMap();
    paintSupply();
  }

  function paintTorque() {
    const { torque, start, pull } = found;
    torqueChart.root.hidden = torque === null;
    if (!torque) return;
    const needs = torque.needed.filter((value) => value > 0);
    const most = Math.max(...torque.available, ...needs);
    const marks = [
      ...(start === undefined ? [] : [line("--enable", [start, start], [0, 2 * most], { width: 1.5 })]),
      ...(pull === undefined ? [] : [line("--error", [pull, pull], [0, 2 * most], { width: 1.5, dash: 4 })]),
    ];
    const last = torque.rate[torque.rate.length - 1];
    draw(torqueChart.canvas, {
      x: { min: 0, max: last, unit: "steps/s", prefix: true, label_px: 20 },
      y: { ...AXIS, prefix: false, min: 0, max: 1.08 * most },
      series: [
        ...(needs.length > 0
          ? [{ ...line("--actual", torque.rate, []), opacity: 0.75, shape: { stems: { y: torque.needed, shift: 0 } } }]
          : []),
        line(
          "--ideal",
          torque.rate,
          torque.available.map((value) => Math.max(value, 0)),
        ),
        ...marks,
      ],
    });
    fill(
      torqueChart.keys,
      key("--ideal", "static curve"),
      ...(needs.length > 0 ? [key("--actual", "the plan's own path")] : []),
      ...(start === undefined ? [] : [key("--enable", "start-stop")]),
      ...(pull === undefined ? [] : [key("--error", "pull-out", true)]),
    );
  }

  function paintMap() {
    const { swing, loses } = found;
    mapChart.root.hidden = swing.length === 0;
    if (swing.length === 0) return;
    const x = Float64Array.from(swing, (_, at) => MAP.from + at * MAP.rung);
    const y = swing.map((value) => Math.min(value, 4));
    draw(mapChart.canvas, {
      x: { min: 0, max: MAP.to, unit: "", prefix: false, label_px: 20 },
      y: { ...AXIS, prefix: false, min: 0, max: Math.max(0.2, 1.08 * Math.max(...y)) },
      series: [
        {
          ...line("--error", x, []),
          opacity: 0.6,
          width: 3,
          shape: { stems: { y: y.map((value, at) => (loses[at] ? value : Number.NaN)), shift: 0 } },
        },
        line("--actual", x, y),
      ],
    });
    fill(mapChart.keys, key("--actual", "swing, peak to peak, drawn up to 4"), key("--error", "loses steps"));
  }

  function paintSupply() {
    const { step: one, pair: two } = found;
    stepChart.root.hidden = one === null;
    pairChart.root.hidden = two === null;
    if (one) {
      const limit = one.rest_a + SHARE * Math.max(one.greatest_a - one.rest_a, one.rest_a - one.least_a);
      const ends = [one.x[0], one.x[one.x.length - 1]];
      draw(stepChart.canvas, {
        x: { min: ends[0], max: ends[1], unit: "s", prefix: true, label_px: 20 },
        y: { ...AXIS, ...around([one.y]) },
        series: [
          line("--axis", ends, [one.rest_a, one.rest_a], { width: 1 }),
          line("--ideal", ends, [limit, limit], { width: 1, dash: 4 }),
          line("--actual", one.x, one.y),
        ],
      });
      fill(stepChart.keys, key("--axis", "at rest"), key("--ideal", "settled below", true));
    }
    if (two) {
      const [together, apart] = two;
      draw(pairChart.canvas, {
        x: {
          min: 0,
          max: Math.max(together.x[together.x.length - 1], apart.x[apart.x.length - 1]),
          unit: "s",
          prefix: true,
          label_px: 20,
        },
        y: { ...AXIS, ...around([together.min, together.max, apart.min, apart.max]) },
        series: two.map((curve, at) => ({
          ...line(["--ideal", "--actual"][at], curve.x, curve.min, { width: 1.4, dash: 0 }),
          shape: shapeOf(curve),
        })),
      });
      fill(pairChart.keys, key("--ideal", "all at once"), key("--actual", "one after another"));
      say(pair, ratio(together, apart));
    }
  }

  function showFacts() {
    const { start, pull, swing, loses } = found;
    const rate = (/** @type {number | undefined} */ value) =>
      value === undefined ? "not even 500 steps/s" : plain(Math.floor(value), "steps/s");
    let peak = 0;
    for (const [at, value] of swing.entries()) if (value > swing[peak]) peak = at;
    facts.show([
      ["Start-stop rate, a turn from rest to rest", rate(start)],
      ["Pull-out rate by this ramp", rate(pull)],
      ...(swing.length > 0
        ? [
            [
              peak === 0 || peak === swing.length - 1 ? "Swings most at the map's edge" : "Swings most at",
              plain(MAP.from + peak * MAP.rung, "full steps/s"),
            ],
            ["by, peak to peak", `${short(swing[peak], 3)} full steps`],
            ["Rates that lose steps", `${loses.filter((value) => value > 0).length} of ${loses.length}`],
          ]
        : []),
    ]);
  }

  /** What is measured becomes the bus' settling time. */
  function take() {
    const cycles = found.step?.reached_cycles;
    if (cycles === null || cycles === undefined) return;
    const bus = controller > 0 ? `controllers[${controller - 1}].bus` : "bus";
    dispatch({ type: "edit", path: `${bus}.settle_cycles`, value: cycles });
  }

  /** @param {State} state @param {boolean} [again] */
  function refresh(state, again = false) {
    const { validation, validated, revision } = state;
    if (validated !== revision || !validation) return;
    panel.classList.toggle("stale", validation.problems.length > 0);
    if (validation.problems.length > 0) return;
    body.hidden = ramp.root.hidden = !state.scenario.plant;
    if (!state.scenario.plant) {
      asked = "";
      return say(
        about,
        "No motor is driven here: choose one in the view Motor, or under Motors and supply in the form.",
      );
    }
    // The controller on show may have gone.
    const selected = state.result?.controller ?? 0;
    const { bus } = [state.scenario, ...state.scenario.controllers][selected] ?? {};
    if (!bus) return;
    controller = selected;
    json = validation.scenario;
    const channel = Math.min(state.axis, bus.channels - 1);
    say(
      about,
      `Motor of channel ${channel}${controller > 0 ? ` of controller ${controller + 1}` : ""}, alone on its supply.`,
    );
    const next = JSON.stringify([json, controller, channel]);
    if (next !== asked) {
      asked = next;
      empty();
      resonance(channel);
      settling(channel, bus.channels);
    } else if (!again) return;
    limits(channel);
  }

  /** What was found is of another motor. */
  function empty() {
    Object.assign(found, nothing());
    facts.show([]);
    for (const text of [settled, pair]) say(text, "");
    press.disabled = true;
    paint();
  }

  /** @param {number} channel */
  function limits(channel) {
    const [of, place] = [json, controller];
    rates.run(
      async (signal, tell) => {
        tell(0, "start-stop and pull-out rate");
        const one = (/** @type {string} */ method, /** @type {any[]} */ ...args) =>
          engine.distribute(method, [[of, place, channel, ...args]], signal).then(([answer]) => answer);
        const [start, pull] = await Promise.all([one("start_stop"), one("pull_out", ramp.value())]);
        const torque = await one("torque_of_motor", 1.1 * Math.max(start ?? 0, pull ?? 0, 1000));
        return { start, pull, torque };
      },
      (answer) => {
        Object.assign(found, answer);
        showFacts();
        paint();
      },
    );
  }

  /** @param {number} channel */
  function resonance(channel) {
    const count = Math.floor((MAP.to - MAP.from) / MAP.rung) + 1;
    const [of, place] = [json, controller];
    map.run(
      async (signal, tell) => {
        /** @type {any[][]} */
        const pieces = [];
        for (let at = 0; at < count; at += MAP.piece)
          pieces.push([of, place, channel, MAP.from + at * MAP.rung, MAP.rung, Math.min(MAP.piece, count - at)]);
        let done = 0;
        tell(0, `resonance: 0 of ${count} rates`);
        return engine.distribute("resonance", pieces, signal, () => {
          done += 1;
          tell(done / pieces.length, `resonance: ${Math.min(count, done * MAP.piece)} of ${count} rates`);
        });
      },
      (answers) => {
        const joined = (/** @type {"swing" | "loses"} */ name) =>
          Float64Array.from(answers.flatMap((answer) => [...answer[name]]));
        Object.assign(found, { swing: joined("swing"), loses: joined("loses") });
        showFacts();
        paint();
      },
    );
  }

  /** The supply current of one step, and then of the run. @param {number} channel @param {number} motors */
  function settling(channel, motors) {
    const [of, place] = [json, controller];
    step.run(
      async (signal, tell) => {
        tell(0, "supply current of one step");
        return engine.distribute("settling", [[of, place, channel]], signal);
      },
      ([answer]) => {
        found.step = answer;
        const clock = now().result?.summary.clock_hz ?? 1;
        const { reached_cycles: reached, settled_cycles: rested, slot_cycles: slot } = answer;
        const time = (/** @type {number | null} */ cycles) =>
          cycles === null
            ? `not within ${si(slot / clock, "s")}`
            : `after ${si(cycles / clock, "s")} (${cycles} cycles)`;
        say(
          settled,
          `One step: it falls to a fifth of its peak ${time(reached)}; it stays within that ${time(rested)}.`,
        );
        press.disabled = reached === null;
        paint();
        pairOf(now(), motors, reached ?? slot);
      },
    );
  }

  /** The supply current of the run with its pulses at once and one after another. @param {State} state @param {number} motors @param {number} settle_cycles  What was measured. */
  function pairOf(state, motors, settle_cycles) {
    const [of, place] = [json, controller];
    const { validation, approved, revision, scenario } = state;
    const why =
      motors < 2
        ? "Of one motor nothing can be staggered."
        : runsAlone(scenario)
          ? "What runs by itself has no ticks: its pulses are not staggered."
          : validation?.cost?.over_budget && approved !== revision
            ? "The run is not made here before it is approved: it is much work."
            : "";
    say(pair, why);
    if (why)
      return both.run(
        async () => null,
        () => {},
      );
    both.run(
      async (signal, tell) => {
        tell(0, "supply current of the run, at once and one after another");
        const path = place > 0 ? `controllers[${place - 1}].bus` : "bus";
        const own = readJson(of);
        const texts = ["simultaneous", "staggered"].map((kind) => {
          const bus = { ...get(own, path), pulse_phasing: kind };
          // Pulses that are one after another already are as far apart as the scenario has them.
          if (kind === "staggered" && get(own, path).pulse_phasing !== kind) Object.assign(bus, { settle_cycles });
          return JSON.stringify(set(own, path, bus));
        });
        return engine.distribute(
          "supply_current",
          texts.map((text) => [text, place, COLUMNS]),
          signal,
        );
      },
      (answer) => {
        found.pair = /** @type {[Supply, Supply]} */ (answer);
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

/** How much less the current is pulled from its rest. @param {Supply} together @param {Supply} apart */
function ratio(together, apart) {
  const worst = (/** @type {Supply} */ { above_a, below_a }) =>
    above_a === null ? null : Math.max(above_a, below_a ?? 0);
  const [most, least] = [worst(together), worst(apart)];
  if (most === null || least === null)
    return "Each motor has to make at least eight steps for the deviations to count.";
  const told = (/** @type {Supply} */ { above_a, below_a }) =>
    `+${short(above_a ?? 0, 3)} A, −${short(below_a ?? 0, 3)} A`;
  return `From its rest the current is pulled by ${told(together)} all at once, by ${told(apart)} one after another: ${short(most / least, 3)} times less.`;
}
