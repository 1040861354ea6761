/** The comparison with the baseline. */
import { byId, element, fill, setText } from "../../dom.js";
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
  const isSame = baseline.revision === result.revision;
  const deviation = isSame
    ? null
    : /** @type {import("../../state/types.js").Deviation | null} */ (
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
  const deviationRow = deviation
    ? [
        [
          "position",
          `maximum difference ${short(deviation.largest)} ${deviation.largest === 1 ? unit.replace(/s$/, "") : unit} at ${time(deviation.at_s)}; RMS ${short(deviation.rms)} ${unit} over the common time of ${si(deviation.common_s, "s")}`,
        ],
      ]
    : [];
  setText(
    byId("compared-title"),
    isSame
      ? `Baseline: ${baseline.title}. Change the experiment or choose a preset. Dashed curves show the baseline.`
      : `Compared with the baseline: ${baseline.title}`,
  );
  fill(
    byId("compared-facts"),
    ...(isSame ? [] : [...rows, ...deviationRow]).map(([name, text]) =>
      element("span", {}, element("b", {}, name), ` ${text}`),
    ),
  );
}

/** @param {string} name @param {number | undefined} own @param {number | undefined} baseline @param {(value: number) => string} print */
function row(name, own, baseline, print) {
  if (own === undefined || baseline === undefined) return [name, "–"];
  const difference = own - baseline;
  return [
    name,
    `${print(own)}, baseline ${print(baseline)}, ${difference === 0 ? "equal" : `${difference > 0 ? "+" : "−"}${print(Math.abs(difference))}`}`,
  ];
}
