/** How a run went, in a sentence: what became of the host's orders, faults, and what a driver could not have followed. */
import { count } from "../state/number.js";
import { selected } from "../state/state.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Summary} Summary */

/** @param {State} state */
export function health(state) {
  const controller = selected(state);
  if (!state.result || !controller) return "";
  const { faults, violations } = controller;
  return [
    state.result.summary.host ? outcome(state.result.summary) : "",
    faults.names.length ? `faults: ${faults.names.join(", ")}` : "",
    violations === null
      ? ""
      : violations === 0
        ? "driver timing met"
        : `${count(violations)} timing ${violations === 1 ? "violation" : "violations"}`,
  ]
    .filter(Boolean)
    .join(" · ");
}

/** Whether something went wrong that nothing made good. A framed line mends what noise does to it. @param {State} state */
export function ill(state) {
  const controller = selected(state);
  const host = state.result?.summary.host;
  const failed = host
    ? host.jobs.some(({ progress }) => progress !== "done")
    : Boolean(controller?.faults.names.length);
  return failed || Boolean(controller?.violations);
}

/** What became of the orders on a framed line. @param {Summary} summary */
function outcome({ host, controllers }) {
  if (!host) return "";
  const { jobs, repeated, crashes } = host;
  const sum = (/** @type {number[]} */ numbers) => numbers.reduce((a, b) => a + b, 0);
  const lost = jobs.filter(({ progress }) => progress === "given_up");
  const ticks = sum(jobs.map((job) => job.ticks));
  const acknowledged = sum(jobs.map((job) => job.acknowledged));
  const parts = [];
  if (lost.length > 0) {
    // The others' names would say nothing where there is one controller only.
    const names =
      controllers.length > 1
        ? lost.map(({ controller, why }) => `on controller ${controller + 1}: ${why}`)
        : [`: ${lost[0].why}`];
    parts.push(`gave up${controllers.length > 1 ? " " : ""}${names.join(", ")}`);
  }
  if (jobs.every(({ progress }) => progress === "done")) parts.push(`all ${count(ticks)} ticks done`);
  else parts.push(`${count(acknowledged)} of ${count(ticks)} ticks acknowledged`);
  if (repeated > 0) parts.push(`${count(repeated)} ${repeated === 1 ? "frame" : "frames"} repeated`);
  if (crashes > 0) parts.push(`the host crashed ${crashes === 1 ? "once" : `${count(crashes)} times`}`);
  return parts.join(", ");
}
