/** Texts about the progress and the result of a run. */
import { count, si } from "../state/number.js";
import { blockedBy, selected } from "../state/queries.js";

/** @typedef {import("../state/types.js").State} State */

/** The line of the header. @param {State} state @param {boolean} long  Whether a run takes so long that its progress is shown. */
export function statusText(state, long) {
  const { progress } = state.run;
  if (long && progress?.end_cycle === 0) return "planning the motion…";
  if (long && progress)
    return `${Math.round((100 * progress.cycle) / Math.max(1, progress.end_cycle))} %, ${count(progress.records)} cycles with edges so far`;
  if (blockedBy(state) === "problems") return "not run: fix the form";
  if (!state.result) return state.run.phase === "running" ? "running…" : "no result yet";
  const { edges = 0 } = selected(state) ?? {};
  return `${count(edges)} edges · ${si(state.result.summary.end_s, "s")}`;
}

/** What the host of a framed line achieved. @param {import("../state/types.js").Summary} summary */
export function hostText({ host, controllers }) {
  if (!host) return "";
  const { jobs, repeated, crashes } = host;
  const sum = (/** @type {number[]} */ numbers) => numbers.reduce((a, b) => a + b, 0);
  const lost = jobs.filter(({ progress }) => progress === "given_up");
  const ticks = sum(jobs.map((job) => job.ticks));
  const acknowledged = sum(jobs.map((job) => job.acknowledged));
  const parts = [];
  if (lost.length > 0) {
    // A single controller needs no name.
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
