/** The summary of the motors: whether they follow, and why one loses steps. */

import { element, fill, setText } from "../../dom.js";
import { Dropped } from "../../engine/request_slots.js";
import { errorMessage } from "../../state/error_message.js";
import { plain, short, si } from "../../state/number.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./numbers.js").Report} Report */

/** @param {{engine: import("../../engine/engine.js").Engine, now: () => State, node: HTMLElement}} page */
export function createSummary({ engine, now, node }) {
  let request = 0;

  /** @param {State} state @param {Report | null} report @param {number} channel */
  async function show(state, report, channel) {
    const own = ++request;
    node.hidden = report === null;
    const motor = report?.motors[channel];
    if (!report || !motor) return;
    const losesSteps = motor.slips > 0;
    const first = element("b", { class: losesSteps ? "error" : "" });
    const isOverloaded = report.plant.overload_cycle !== null;
    setText(first, `${losesSteps ? "⚠ " : isOverloaded ? "" : "✓ "}Motor ${channel} ${motor.verdict}.`);
    const details = element("span");
    fill(
      node,
      ...(isOverloaded ? [element("b", { class: "error" }, overload(report, state)), " "] : []),
      first,
      " ",
      details,
    );
    const warnings = [motor.grid_too_coarse, motor.energy_left_over].filter(Boolean).map((warning) => `⚠ ${warning}.`);
    setText(details, [...warnings, others(report, channel), supply(report)].filter(Boolean).join(" "));
    if (!losesSteps) return;
    const cause = await causeOf(state, channel).catch((error) =>
      error instanceof Dropped ? "" : ` (the cause is unknown: ${errorMessage(error)})`,
    );
    if (cause && own === request) setText(first, `⚠ Motor ${channel} ${motor.verdict}${cause}.`);
  }

  /** Compares the rate of the first two steps with the start-stop rate. @param {State} state @param {number} channel */
  async function causeOf(state, channel) {
    const { result } = state;
    const edges = await engine.request("edges", channel, -1, true, 3);
    const rises = (edges?.rows ?? []).filter((/** @type {{high: boolean}} */ { high }) => high);
    if (rises.length < 2 || !result) return "";
    const rate = result.summary.clock_hz / (rises[1].cycle - rises[0].cycle);
    const startStopRate = await engine.computeForRun("start rate", "start_stop", result.controller, channel);
    if (now().result !== result) return "";
    if (startStopRate === undefined) return ": it does not start at 500 steps/s";
    const [rateText, limitText] = [plain(Math.round(rate), "steps/s"), plain(Math.floor(startStopRate), "steps/s")];
    return rate > startStopRate
      ? `: it starts at ${rateText}, above its start-stop rate of ${limitText}`
      : `; it starts at ${rateText}, within its start-stop rate of ${limitText}, so it stalls during the move`;
  }

  return { show };
}

/** The text about the other motors. @param {Report} report @param {number} channel */
function others({ motors, plant }, channel) {
  const lost = motors.filter(({ slips }, at) => at !== channel && slips > 0).map(({ channel: at }) => at);
  if (motors.length < 2) return "";
  if (lost.length === 0) return plant.overload_cycle === null ? "All other motors follow." : "";
  if (lost.length === 1) return `Motor ${lost[0]} also loses steps.`;
  return `Motors ${lost.slice(0, -1).join(", ")} and ${lost.at(-1)} also lose steps.`;
}

/** @param {Report} report @param {State} state */
function overload({ plant }, { result }) {
  return `⚠ Overload at ${si((plant.overload_cycle ?? 0) / (result?.summary.clock_hz ?? 1), "s")}: all drivers are switched off.`;
}

/** @param {Report} report */
function supply({ plant }) {
  const parts = [
    `Supply ${short(plant.load_least_a, 3)} to ${short(plant.load_greatest_a, 3)} A, RMS ${short(plant.load_rms_a, 3)} A`,
  ];
  if (plant.bus_least_v !== plant.bus_greatest_v)
    parts.push(`bus ${short(plant.bus_least_v, 4)} to ${short(plant.bus_greatest_v, 4)} V`);
  const collapse =
    plant.collapsed_at_s === null
      ? ""
      : `⚠ The supply collapses at ${si(plant.collapsed_at_s, "s")}: use a stronger source or less load.`;
  return `${parts.join(", ")}. ${collapse}`.trim();
}
