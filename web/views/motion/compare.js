/** Two runs on one axis: a run is kept, and every later one is drawn and measured beside it. */
import { button, byId, element, fill, say } from "../../dom.js";
import { unlessDropped } from "../../engine/engine.js";
import { count, plain, short, si, time } from "../../state/number.js";
import { selected } from "../../state/state.js";
import { unitPair } from "./ask.js";
import { keptAxis, unitOf } from "./bands.js";

/** @typedef {import("../../state/types.js").State} State */

/** @param {{engine: import("../../engine/engine.js").Engine} & import("../../state/types.js").Page} page */
export function createCompare({ engine, dispatch, now }) {
  const place = byId("compared");
  const keepButton = /** @type {HTMLButtonElement} */ (byId("keep-run"));
  const change = /** @type {HTMLInputElement} */ (byId("show-difference"));
  const drop = button("Drop", "Drop the kept run", () => {
    dispatch({ type: "reference", reference: null });
    keepButton.focus();
  });
  [drop.className, drop.hidden] = ["with-kept", true];
  byId("kept-buttons").append(drop);
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
      type: "reference",
      reference: {
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
    const { reference, result } = state;
    place.hidden = !reference;
    if (!reference || !result) return;
    const looked = selected(state);
    const kept = keptAxis(state);
    const own = state.derived?.controllers[result.controller]?.axes[state.axis];
    const { unit, scale, kept: keptScale } = unitOf(state);
    const same = reference.revision === result.revision;
    const apart = same
      ? null
      : /** @type {import("../../state/types.js").Apart | null} */ (
          await engine
            .latest("apart", "baseline_apart", reference.controller, state.axis, kept.index, unitPair(state))
            .catch(unlessDropped)
        );
    const rows = [
      row("duration", own?.duration_s, kept.derived?.duration_s, (value) => time(value)),
      row(
        "peak speed",
        own && own.peak_speed_steps_s * scale,
        kept.derived && kept.derived.peak_speed_steps_s * keptScale,
        (value) => plain(value, `${unit}/s`),
      ),
      row(
        "peak acceleration",
        own && own.peak_acceleration_steps_s2 * scale,
        kept.derived && kept.derived.peak_acceleration_steps_s2 * keptScale,
        (value) => plain(value, `${unit}/s²`),
      ),
      row("edges", looked?.edges, reference.summary.controllers[reference.controller].edges, count),
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
        ? `Kept: ${reference.title}. Change the experiment or choose a preset; the kept run stays as dashed curves.`
        : `Against the kept run: ${reference.title}`,
    );
    fill(
      byId("compared-facts"),
      ...(same ? [] : [...rows, ...far]).map(([name, text]) => element("span", {}, element("b", {}, name), ` ${text}`)),
    );
  }

  /** @param {string} name @param {number | undefined} own @param {number | undefined} kept @param {(value: number) => string} print */
  function row(name, own, kept, print) {
    if (own === undefined || kept === undefined) return [name, "–"];
    const by = own - kept;
    return [
      name,
      `${print(own)}, kept ${print(kept)}, ${by === 0 ? "the same" : `${by > 0 ? "+" : "−"}${print(Math.abs(by))}`}`,
    ];
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    keepButton.disabled = state.result === null || state.result.revision !== state.revision;
    const { reference, result, axis, unit, derived } = state;
    if (before?.reference !== reference) {
      if (before?.reference && !reference) engine.ask("baseline", false).catch(unlessDropped);
      for (const node of document.querySelectorAll(".with-kept")) /** @type {HTMLElement} */ (node).hidden = !reference;
      keepButton.textContent = reference ? "Keep this instead" : "Keep to compare";
    }
    change.checked = state.difference;
    if (
      before?.reference !== reference ||
      (reference &&
        (before?.result !== result || before?.axis !== axis || before?.unit !== unit || before?.derived !== derived))
    )
      void tell(state);
  }
  return { render };
}
