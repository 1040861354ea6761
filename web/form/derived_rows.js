/** The derived values of a scenario in the form. */
import { count, counted, plain, pretty, short, si } from "../state/number.js";
import { get } from "../state/paths.js";
import { derivedAxis } from "../state/queries.js";
import { hasNoLine } from "./source_kinds.js";

/** @typedef {import("../state/types.js").State} State */

/** @typedef {[name: string, value: string, mark: "" | "over", term: string]} DerivedRow  `over`: the value exceeds its limit. `term`: id of the help text. */
/** @param {State} state @param {import("../state/types.js").Derived} derived @returns {DerivedRow[]} */
export function derivedRows(state, derived) {
  const [{ tick_s, limit_steps_s }] = derived.controllers;
  // Additional controllers can have ticks of different length.
  const several = derived.controllers.length > 1;
  const ticks = several ? derived.controllers[0].ticks : derived.ticks;
  const axes = derived.controllers.flatMap((controller) => controller.axes);
  const peak = Math.max(0, ...axes.map((axis) => axis.peak_speed_steps_s));
  const fastest = axes.find((axis) => axis.peak_speed_steps_s === peak);
  const unit = state.unit ?? fastest?.unit;
  const stepLength = unit === "mm" ? fastest?.step_mm : unit === "deg" ? fastest?.step_deg : null;
  const peakInUnit = stepLength ? ` · ${short(peak * stepLength, 5)}\u00a0${unit === "deg" ? "°" : "mm"}/s` : "";
  const load = derived.line_load;
  const { source, line } = state.scenario;
  const sends = "line" in source;
  const isLineless = hasNoLine(state.scenario);
  const over =
    !isLineless &&
    derived.controllers.some((controller) =>
      controller.axes.some((axis) => axis.peak_speed_steps_s > controller.limit_steps_s),
    );
  return [
    // The exact end of packets, of line scripts and of runs with line faults is known only after the run.
    [
      line.protocol === "framed" && !isLineless && !sends
        ? "Approximate duration"
        : sends || "packets" in source || (!isLineless && !hasNoFaults(line))
          ? "Maximum duration"
          : "Duration",
      si(derived.duration_s, "s"),
      "",
      "duration",
    ],
    ["Peak rate", axes.length ? plain(peak, "steps/s") + peakInUnit : "–", over ? "over" : "", "peak_rate"],
    ...(isLineless
      ? [/** @type {DerivedRow} */ (["On the line", "nothing", "", "on_the_line"])]
      : /** @type {DerivedRow[]} */ ([
          [
            several ? "Tick of controller 1" : "Tick",
            sends ? si(tick_s, "s") : `${si(tick_s, "s")}, ${count(ticks)} in total`,
            "",
            "tick",
          ],
          [several ? "Max step rate of controller 1" : "Max step rate", plain(limit_steps_s, "steps/s"), "", "limit"],
          trafficRow(state, derived),
          [
            "Line load",
            load === null ? "–" : `${short(load * 100, 3)} %`,
            load !== null && load > 1 ? "over" : "",
            "line_load",
          ],
        ])),
  ];
}

/** Whether the line has no faults. @param {any} line */
function hasNoFaults({ glitches, noise }) {
  return glitches.length === 0 && Object.entries(noise).every(([key, value]) => key === "seed" || value === 0);
}

/** The number or rate of sends, frames or packets. @param {State} state @param {import("../state/types.js").Derived} derived @returns {DerivedRow} */
function trafficRow({ scenario: { source, line }, result, revision }, { sends, line_load, controllers }) {
  if ("line" in source) return ["Sends", count(sends), "", "Source.line"];
  // The number of repeated frames on a noisy line is known only after the run; without a bound if the host restarts.
  const host = result?.revision === revision ? result.summary.host : null;
  const limit = line.noise.host_crashes_ppm > 0 ? "after the run" : `at most ${count(sends)}`;
  if (line.protocol === "framed")
    return ["Frames", host ? count(host.frames) : hasNoFaults(line) ? count(sends) : limit, "", "ScriptedSend.frame"];
  const activeControllers = controllers.filter(({ ticks }) => ticks > 0).length;
  return [
    "Packets",
    line_load === null ? "–" : plain(activeControllers / controllers[0].tick_s, "/s"),
    "",
    "rate_of_packets",
  ];
}

/** @param {string} path @param {State} state */
export function moveNote(path, state) {
  const [, index] = path.match(/\.moves\[(\d+)\]/) ?? [];
  const move = derivedAxis(state, path)?.moves[Number(index)];
  if (!move) return { text: "", warning: "" };
  const [kind] = Object.keys(get(state.scenario, path) ?? {});
  const steps = move.steps === 0 && kind?.startsWith("sine") ? "back at the start" : counted(move.steps, "step");
  return {
    text: [`${si(move.start_s, "s")} to ${si(move.start_s + move.duration_s, "s")}`, steps, pretty(move.detail ?? "")]
      .filter(Boolean)
      .join(" · "),
    warning: move.warning && ` ⚠ Motor: ${pretty(move.warning)}.`,
  };
}
