/** The derived values of a scenario in the form. */
import { count, counted, plain, pretty, short, si } from "../state/number.js";
import { get } from "../state/paths.js";
import { derivedAxis } from "../state/queries.js";
import { hasNoLine } from "./source_kinds.js";

/** @typedef {import("../state/types.js").State} State */

/** Name, value, `over` where it is too much, and the term that explains it. @param {State} state @param {import("../state/types.js").Derived} derived @returns {[string, string, string, string][]} */
export function derivedRows(state, derived) {
  const [{ tick_s, limit_steps_s }] = derived.controllers;
  // Additional controllers can have ticks of another length.
  const several = derived.controllers.length > 1;
  const ticks = several ? derived.controllers[0].ticks : derived.ticks;
  const axes = derived.controllers.flatMap((controller) => controller.axes);
  const peak = Math.max(0, ...axes.map((axis) => axis.peak_speed_steps_s));
  const way =
    state.unit === "steps" ? null : axes.find((axis) => axis.peak_speed_steps_s === peak)?.[`step_${state.unit}`];
  const along = way ? ` · ${short(peak * way, 5)}\u00a0${state.unit === "deg" ? "°" : "mm"}/s` : "";
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
    // When the last tick of packets or of a line script begins and ends, and what becomes of it on a line that goes wrong, is known only after the run.
    [
      line.protocol === "framed" && !isLineless && !sends
        ? "Duration, about"
        : sends || "packets" in source || (!isLineless && !isQuiet(line))
          ? "Duration at most"
          : "Duration",
      si(derived.duration_s, "s"),
      "",
      "duration",
    ],
    ["Peak rate", axes.length ? plain(peak, "steps/s") + along : "–", over ? "over" : "", "peak_rate"],
    ...(isLineless
      ? [/** @type {[string, string, string, string]} */ (["On the line", "nothing", "", "on_the_line"])]
      : /** @type {[string, string, string, string][]} */ ([
          [
            several ? "Tick of controller 1" : "Tick",
            sends ? si(tick_s, "s") : `${si(tick_s, "s")}, ${count(ticks)} in total`,
            "",
            "tick",
          ],
          [several ? "Max step rate of controller 1" : "Max step rate", plain(limit_steps_s, "steps/s"), "", "limit"],
          sent(state, derived),
          [
            "Line load",
            load === null ? "–" : `${short(load * 100, 3)} %`,
            load !== null && load > 1 ? "over" : "",
            "line_load",
          ],
        ])),
  ];
}

/** Whether nothing on the line goes wrong. @param {any} line */
function isQuiet({ glitches, noise }) {
  return glitches.length === 0 && Object.entries(noise).every(([key, value]) => key === "seed" || value === 0);
}

/** What goes over the line: how much, or how often. @param {State} state @param {import("../state/types.js").Derived} derived @returns {[string, string, string, string]} */
function sent({ scenario: { source, line }, result, revision }, { sends, line_load, controllers }) {
  if ("line" in source) return ["Sends", count(sends), "", "Source.line"];
  // How many are repeated on a noisy line only the run tells; a controller that dies is asked everything again.
  const ran = result?.revision === revision ? result.summary.host : null;
  const most = line.noise.host_crashes_ppm > 0 ? "after the run" : `at most ${count(sends)}`;
  if (line.protocol === "framed")
    return ["Frames", ran ? count(ran.frames) : isQuiet(line) ? count(sends) : most, "", "ScriptedSend.frame"];
  const busy = controllers.filter(({ ticks }) => ticks > 0).length;
  return ["Packets", line_load === null ? "–" : plain(busy / controllers[0].tick_s, "/s"), "", "rate_of_packets"];
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
