/** Results of the timing check, with navigation between violations. */
import { byId } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { ruleName } from "../form/schema.js";
import { si, time } from "../state/number.js";
import { endOf, shown } from "../state/time_window.js";
import { required } from "./required.js";
import { paintTiming } from "./timing_table.js";

/** @typedef {import("../state/types.js").Timing} Timing */

/** First bit of DIR (contract A3). */
const DIR = 16;
/** Length of the window of a violation, relative to its time. */
const WINDOW_FACTOR = 14;

/** @param {{engine: import("../engine/engine.js").Engine, drivers: import("../state/types.js").DriverSheet[], showNote: (text: string) => void} & import("../state/types.js").Page} page */
export function createResults({ engine, drivers, showNote, dispatch, now }) {
  const body = /** @type {Element} */ (byId("violations").querySelector("tbody"));
  /** @type {Timing | null} */
  let timing = null;
  let current = -1;
  body.addEventListener("click", (event) => {
    const row = /** @type {HTMLElement} */ (event.target).closest("tr");
    if (row) show(Number(row.dataset.index));
  });

  /** The next violation after cursor A, or after the one that is selected. @param {Timing} found @param {boolean} forward */
  async function next(found, forward) {
    setTiming(found);
    const state = now();
    const selected = timing?.violations[current];
    const { a } = state.cursors;
    // Several violations may be in one cycle, so from the selected one the index decides.
    if (selected && selected.cycle === a) return show(current + (forward ? 1 : -1));
    const index = await engine
      .request("next_violation", a ?? (forward ? -1 : endOf(state)), forward)
      .catch(unlessDropped);
    show(index ?? -1);
  }

  /** Shows the first violation of a rule, or the time with the smallest slack. @param {string} rule */
  function showRule(rule) {
    const first = timing?.violations.findIndex((each) => each.rule === rule) ?? -1;
    const { shortest, required_cycles } = timing?.rules.find((each) => each.rule === rule) ?? {};
    if (first >= 0) return show(first);
    if (!shortest) return showNote(`${ruleName(rule)}: not measured in this run.`);
    current = -1;
    const clock = now().result?.summary.clock_hz ?? 1;
    showMeasured({
      cycle: shortest.cycle,
      channel: shortest.channel,
      rule,
      measured_cycles: shortest.measured_cycles,
      required_cycles: required_cycles ?? 0,
    });
    showNote(
      `${ruleName(rule)}: shortest ${si(shortest.measured_cycles / clock, "s")}, channel ${shortest.channel}, at ${time(shortest.cycle / clock)}.`,
    );
  }

  /** Shows a measured time in the pulses, with cursor A at the edge that ends it. @param {import("../state/types.js").Violation} measured */
  function showMeasured({ cycle, channel, rule, measured_cycles, required_cycles }) {
    dispatch({ type: "cursor", which: "a", cycle });
    dispatch({ type: "row", row: rule.startsWith("dir") ? DIR + channel : channel });
    const wanted = WINDOW_FACTOR * Math.max(1, measured_cycles, required_cycles);
    const { start, end } = shown(now());
    if (cycle < start || cycle > end || end - start > 20 * wanted) {
      dispatch({ type: "window", window: { start: cycle - wanted / 2, end: cycle + wanted / 2 } });
    }
    mark();
    // On a narrow screen the pulses are another tab.
    if (matchMedia("(max-width: 899px)").matches) dispatch({ type: "view", view: "pulses" });
  }

  /** Shows a violation in the pulses. @param {number} index */
  function show(index) {
    const violation = timing?.violations[index];
    if (!violation) return showNote("No more violations in this direction.");
    const { cycle, channel, rule, measured_cycles } = violation;
    current = index;
    showMeasured(violation);
    const clock = now().result?.summary.clock_hz ?? 1;
    showNote(
      `Violation ${index + 1} of ${timing?.violations.length}: channel ${channel}, ${ruleName(rule)} ${si(measured_cycles / clock, "s")} at ${time(cycle / clock)}, ${required(timing, rule)} required.`,
    );
  }

  function mark() {
    for (const row of body.children) {
      const selected = /** @type {HTMLElement} */ (row).dataset.index === String(current);
      row.classList.toggle("current", selected);
      if (selected) row.scrollIntoView({ block: "nearest" });
    }
  }

  /** Shows the result of a check. @param {Timing | null} next */
  function setTiming(next) {
    if (next === timing) return;
    [timing, current] = [next, -1];
    paintTiming(timing, { state: now(), drivers, showRule });
  }
  return { next, setTiming };
}
