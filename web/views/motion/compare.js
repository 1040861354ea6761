/** Two runs on one axis: a run is kept as the baseline, and every later one is drawn and measured beside it. */
import { button, byId, element, fill, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, plain, short, si, time } from "../../state/number.js";
import { selected } from "../../state/state.js";
import { unitPair } from "./ask.js";
import { baselineAxis, unitOf } from "./bands.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createCompare({ engine, dispatch, now }) {
  const place = byId("compared");
  const keepButton = /** @type {HTMLButtonElement} */ (byId("keep-run"));
  const change = /** @type {HTMLInputElement} */ (byId("show-difference"));
  const drop = button("Drop", "Drop the baseline", () => {
    dispatch({ type: "baseline", baseline: null });
    keepButton.focus();
  });
  [drop.className, drop.hidden] = ["with-baseline", true];
  byId("baseline-buttons").append(drop);
  keepButton.addEventListener("click", () => void keep());
  change.addEventListener("change", () => dispatch({ type: "difference", on: change.checked }));

  async function keep() {
    const { result, scenario, derived, origin, revision } = now();
    // What is kept is what the worker has: only a run of the scenario in the form.
    if (!result || result.revision !== revision || !(await engine.ask("baseline", true).catch(unlessDropped))) return;
    const title =
      scenario.title ||
      (origin.startsWith("preset:")
        ? origin.slice(7)
        : `of digest ${result.summary.controllers[result.controller].digest.slice(0, 8)}`);
    dispatch({
      type: "baseline",
      baseline: {
        title,
        revision,
        summary: result.summary,
        controller: result.controller,
        derived: derived?.controllers[result.controller] ?? null,
      },
    });
  }

  /** @param {State} state */
  async function tell(state) {
    const { baseline, result } = state;
    place.hidden = !baseline;
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
            `differs by ${short(apart.largest)} ${unit} at most, at ${time(apart.at_s)}; RMS ${short(apart.rms)} ${unit} over the common ${si(apart.common_s, "s")}`,
          ],
        ]
      : [];
    say(
      byId("compared-title"),
      same
        ? `Baseline: ${baseline.title}. Change the experiment or choose a preset; the baseline stays as dashed curves.`
        : `Against the baseline: ${baseline.title}`,
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
      `${print(own)}, baseline ${print(baseline)}, ${by === 0 ? "the same" : `${by > 0 ? "+" : "−"}${print(Math.abs(by))}`}`,
    ];
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    keepButton.disabled = state.result === null || state.result.revision !== state.revision;
    const { baseline, result, axis, unit, derived } = state;
    if (before?.baseline !== baseline) {
      if (before?.baseline && !baseline) engine.ask("baseline", false).catch(unlessDropped);
      for (const node of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll(".with-baseline")))
        node.hidden = !baseline;
      keepButton.textContent = baseline ? "Keep this instead" : "Keep to compare";
    }
    change.checked = state.difference;
    if (
      before?.baseline !== baseline ||
      (baseline &&
        (before?.result !== result || before?.axis !== axis || before?.unit !== unit || before?.derived !== derived))
    )
      void tell(state);
  }
  return { render };
}
