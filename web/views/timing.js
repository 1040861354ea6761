/**
 * The timing check: could the driver have followed the pulses? A row a rule with what was measured, what is
 * required and the slack, and the violations one by one. It takes the spectrum's place where there is a driver.
 */
import { byId, say } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { ruleName } from "../form/schema.js";
import { listen } from "../shell/commands.js";
import { si, time } from "../state/number.js";
import { endOf, selected, shown } from "../state/state.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Timing} Timing */

/** First bit of DIR (contract A3). */
const DIR = 16;
/** A violation is shown in a window of so many of the times that it is about. */
const AROUND = 14;

/** @param {{engine: import("../engine/engine.js").Engine, drivers: import("../state/types.js").DriverSheet[], speak: (text: string) => void} & import("../state/types.js").Page} page */
export function createTiming({ engine, drivers, speak, dispatch, now }) {
  const body = /** @type {Element} */ (byId("violations").querySelector("tbody"));
  /** @type {Timing | null} */
  let timing = null;
  let current = -1;
  /** It loads with the first driver. @type {typeof import("./timing_table.js").paintTiming | null} */
  let paint = null;

  for (const where of ["", "pulses-"]) {
    byId(`${where}violation-previous`).addEventListener("click", () => next(false));
    byId(`${where}violation-next`).addEventListener("click", () => next(true));
  }
  for (const id of ["pulses", "view-timing"]) {
    listen(byId(id), "Driver timing (pulses and timing)", [
      { keys: ["v"], text: "next violation", run: () => void next(true) },
      { keys: ["Shift+V"], text: "previous violation", run: () => void next(false) },
    ]);
  }
  body.addEventListener("click", (event) => {
    const row = /** @type {HTMLElement} */ (event.target).closest("tr");
    if (row) show(Number(row.dataset.index));
  });

  /** The next violation after cursor A, or after the one that is chosen. @param {boolean} forward */
  async function next(forward) {
    const state = now();
    if (!timing) return tell("There is no driver whose timing could be broken.");
    const chosen = timing?.violations[current];
    const { a } = state.cursors;
    // Several may lie in one cycle; from the chosen one they are gone through one by one.
    if (chosen && chosen.cycle === a) return show(current + (forward ? 1 : -1));
    const index = await engine.ask("next_violation", a ?? (forward ? -1 : endOf(state)), forward).catch(unlessDropped);
    show(index ?? -1);
  }

  /** Says it in this view and, visibly, in the pulses. @param {string} text */
  function tell(text) {
    say(byId("timing-sentence"), text);
    speak(text);
  }

  /** The first violation of a rule, or where it came nearest to one. @param {string} rule */
  function toRule(rule) {
    const first = timing?.violations.findIndex((each) => each.rule === rule) ?? -1;
    const { least, required_cycles } = timing?.rules.find((each) => each.rule === rule) ?? {};
    if (first >= 0) return show(first);
    if (!least) return tell(`${ruleName(rule)}: never measured in this run.`);
    current = -1;
    const clock = now().result?.summary.clock_hz ?? 1;
    go({
      cycle: least.cycle,
      channel: least.channel,
      rule,
      measured_cycles: least.measured_cycles,
      required_cycles: required_cycles ?? 0,
    });
    tell(
      `${ruleName(rule)}: least ${si(least.measured_cycles / clock, "s")}, channel ${least.channel}, at ${time(least.cycle / clock)}.`,
    );
  }

  /** Shows a measured time in the pulses, the edge that ends it at cursor A. @param {import("../state/types.js").Violation} measured */
  function go({ cycle, channel, rule, measured_cycles, required_cycles }) {
    dispatch({ type: "cursor", which: "a", cycle });
    dispatch({ type: "row", row: rule.startsWith("dir") ? DIR + channel : channel });
    const wanted = AROUND * Math.max(1, measured_cycles, required_cycles);
    const { start, end } = shown(now());
    if (cycle < start || cycle > end || end - start > 20 * wanted) {
      dispatch({ type: "window", window: { start: cycle - wanted / 2, end: cycle + wanted / 2 } });
    }
    mark();
    // On a narrow screen the pulses are another tab.
    if (matchMedia("(max-width: 899px)").matches) dispatch({ type: "view", view: "pulses" });
  }

  /** Shows a violation in the pulses, its edge at cursor A. @param {number} index */
  function show(index) {
    const violation = timing?.violations[index];
    if (!violation) return tell("No further violation that way.");
    const { cycle, channel, rule, measured_cycles } = violation;
    current = index;
    go(violation);
    const clock = now().result?.summary.clock_hz ?? 1;
    tell(
      `Violation ${index + 1} of ${timing?.violations.length}: channel ${channel}, ${ruleName(rule)} ${si(measured_cycles / clock, "s")} at ${time(cycle / clock)}, ${required(timing, rule)} required.`,
    );
  }

  function mark() {
    for (const row of body.children) {
      const chosen = /** @type {HTMLElement} */ (row).dataset.index === String(current);
      row.classList.toggle("current", chosen);
      if (chosen) row.scrollIntoView({ block: "nearest" });
    }
  }

  /** @param {State} state */
  async function refresh(state) {
    current = -1;
    say(byId("timing-sentence"), "");
    const answer =
      selected(state)?.violations === null ? null : await engine.latest("timing", "timing").catch(unlessDropped);
    if (answer === undefined) return;
    timing = answer;
    // Without a driver there is nothing to paint, and nowhere.
    if (!timing && !paint) return;
    try {
      paint ??= (await import("./timing_table.js")).paintTiming;
      paint(timing, { state: now(), drivers, toRule, required });
    } catch {
      tell("This part of the page could not be loaded; try again when the network is there.");
    }
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.result !== state.result) return refresh(state);
    return undefined;
  }
  return { render };
}

/** The least time that a rule asks for; in cycles it is rounded up. @param {Timing | null} timing @param {string} rule */
export function required(timing, rule) {
  return si((timing?.rules.find((each) => each.rule === rule)?.required_ns ?? 0) * 1e-9, "s");
}
