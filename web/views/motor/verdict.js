/** Whether the motors follow, and why one loses steps. */
import { element, fill, say } from "../../dom.js";
import { Dropped } from "../../engine/request_slots.js";
import { plain, short, si } from "../../state/number.js";

/** @typedef {import("../../state/types.js").State} State */
/** @typedef {import("./numbers.js").Report} Report */

/** @param {{engine: import("../../engine/engine.js").Engine, now: () => State, node: HTMLElement}} page */
export function createVerdict({ engine, now, node }) {
  let request = 0;

  /** @param {State} state @param {Report | null} report @param {number} channel */
  async function show(state, report, channel) {
    const own = ++request;
    node.hidden = report === null;
    const motor = report?.motors[channel];
    if (!report || !motor) return;
    const loses = motor.slips > 0;
    const first = element("b", { class: loses ? "error" : "" });
    const stopped = report.plant.overload_cycle !== null;
    say(first, `${loses ? "⚠ " : stopped ? "" : "✓ "}Motor ${channel} ${motor.verdict}.`);
    const rest = element("span");
    fill(node, ...(stopped ? [element("b", { class: "error" }, overload(report, state)), " "] : []), first, " ", rest);
    const coarse = [motor.grid_too_coarse, motor.energy_left_over].filter(Boolean).map((warning) => `⚠ ${warning}.`);
    say(rest, [...coarse, others(report, channel), supply(report)].filter(Boolean).join(" "));
    if (!loses) return;
    const why = await reason(state, channel).catch((error) =>
      error instanceof Dropped ? "" : ` (the cause is unknown: ${error instanceof Error ? error.message : error})`,
    );
    if (why && own === request) say(first, `⚠ Motor ${channel} ${motor.verdict}${why}.`);
  }

  /** The rate of the first two steps against what the motor starts at. @param {State} state @param {number} channel */
  async function reason(state, channel) {
    const of = state.result;
    const edges = await engine.request("edges", channel, -1, true, 3);
    const rises = (edges?.rows ?? []).filter((/** @type {{high: boolean}} */ { high }) => high);
    if (rises.length < 2 || !of) return "";
    const rate = of.summary.clock_hz / (rises[1].cycle - rises[0].cycle);
    const found = await engine.considerRun("start rate", "start_stop", of.controller, channel);
    if (now().result !== of) return "";
    if (found === undefined) return ": it does not start at 500 steps/s";
    const [own, most] = [plain(Math.round(rate), "steps/s"), plain(Math.floor(found), "steps/s")];
    return rate > found
      ? `: it starts at ${own}, above its start-stop rate of ${most}`
      : `; it starts at ${own}, within its start-stop rate of ${most}, so it stalls during the move`;
  }

  return { show };
}

/** The other motors in a few words. @param {Report} report @param {number} channel */
function others({ motors }, channel) {
  const lost = motors.filter(({ slips }, at) => at !== channel && slips > 0).map(({ channel: at }) => at);
  if (motors.length < 2) return "";
  return lost.length > 0 ? `Motor ${lost.join(", ")} also loses steps.` : "All other motors follow.";
}

/** @param {Report} report @param {State} state */
function overload({ plant }, { result }) {
  return `⚠ Overload at ${si((plant.overload_cycle ?? 0) / (result?.summary.clock_hz ?? 1), "s")}: the drivers are then off.`;
}

/** @param {Report} report */
function supply({ plant }) {
  const parts = [
    `Supply ${short(plant.load_least_a, 3)} to ${short(plant.load_greatest_a, 3)} A, r.m.s. ${short(plant.load_rms_a, 3)} A`,
  ];
  if (plant.bus_least_v !== plant.bus_greatest_v)
    parts.push(`bus ${short(plant.bus_least_v, 4)} to ${short(plant.bus_greatest_v, 4)} V`);
  const collapse =
    plant.collapsed_at_s === null
      ? ""
      : `⚠ The supply collapses at ${si(plant.collapsed_at_s, "s")}: use a stronger source or less load.`;
  return `${parts.join(", ")}. ${collapse}`.trim();
}
