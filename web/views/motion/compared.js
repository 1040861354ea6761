/** The comparison with the baseline. */
import { byId, element, fill, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, plain, short, si, time } from "../../state/number.js";
import { selected } from "../../state/queries.js";
import { baselineAxis, unitOf } from "./bands.js";
import { unitPair } from "./request_columns.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {import("../../engine/engine.js").Engine} engine @param {State} state */
export async function showCompared(engine, state) {
  const { baseline, result } = state;
  if (!baseline || !result) return;
  const controller = selected(state);
  const other = baselineAxis(state);
  const own = state.derived?.controllers[result.controller]?.axes[state.axis];
  const { unit, scale, baseline: baselineScale } = unitOf(state);
  const same = baseline.revision === result.revision;
  const apart = same
    ? null
    : /** @type {import("../../state/types.js").Apart | null} */ (
        await engine
          .latest("apart", "baseline_apart", baseline.controller, state.axis, other.index, unitPair(state))
          .catch(unlessDropped)
      );
  const rows = [
    row("duration", own?.duration_s, other.derived?.duration_s, (value) => time(value)),
    row(
      "peak speed",
      own && own.peak_speed_steps_s * scale,
      other.derived && other.derived.peak_speed_steps_s * baselineScale,
      (value) => plain(value, `${unit}/s`),
    ),
    row(
      "peak acceleration",
      own && own.peak_acceleration_steps_s2 * scale,
      other.derived && other.derived.peak_acceleration_steps_s2 * baselineScale,
      (value) => plain(value, `${unit}/s²`),
    ),
    row("edges", controller?.edges, baseline.summary.controllers[baseline.controller].edges, count),
  ];
  const far = apart
    ? [
        [
          "position",
          `maximum difference ${short(apart.largest)} ${apart.largest === 1 ? unit.replace(/s$/, "") : unit} at ${time(apart.at_s)}; RMS ${short(apart.rms)} ${unit} over the common time of ${si(apart.common_s, "s")}`,
        ],
      ]
    : [];
  say(
    byId("compared-title"),
    same
      ? `Baseline: ${baseline.title}. Change the experiment or choose a preset. Dashed curves show the baseline.`
      : `Compared with the baseline: ${baseline.title}`,
  );
  fill(
    byId("compared-facts"),
    ...(same ? [] : [...rows, ...far]).map(([name, text]) => element("span", {}, element("b", {}, name), ` ${text}`)),
  );
}

/** @param {string} name @param {number | undefined} own @param {number | undefined} baseline @param {(value: number) => string} print */
function row(name, own, baseline, print) {
  if (own === undefined || baseline === undefined) return [name, "–"];
  const by = own - baseline;
  return [
    name,
    `${print(own)}, baseline ${print(baseline)}, ${by === 0 ? "equal" : `${by > 0 ? "+" : "−"}${print(Math.abs(by))}`}`,
  ];
}
