/**
 * The timing check: could the driver have followed the pulses? A row a rule with what was measured, what is
 * required and the slack, and the violations one by one. It takes the spectrum's place where there is a driver.
 */
import { byId, element, fill, say } from "../dom.js";
import { unlessDropped } from "../engine/engine.js";
import { ruleName } from "../form/schema.js";
import { listen } from "../shell/commands.js";
import { count, si, time } from "../state/number.js";
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
    paint(now());
  }

  /** @param {State} state */
  function paint(state) {
    const clock = state.result?.summary.clock_hz ?? 1;
    const at = (/** @type {number} */ cycles) => si(cycles / clock, "s");
    const sheet = drivers.find(({ id }) => id === timing?.driver);
    const total = timing?.total ?? 0;
    const kept = timing?.violations.length ?? 0;
    say(byId("timing-driver"), sheet?.name ?? "rules of your own");
    byId("timing-driver").title = sheet?.source ?? "";
    const few = total > kept ? `; the first ${count(kept)} are listed` : "";
    say(
      byId("timing-total"),
      total === 0
        ? "The pulses meet the data sheet’s timing: no violation."
        : `${count(total)} ${total === 1 ? "violation" : "violations"}${few}.`,
    );
    byId("timing-total").classList.toggle("error", total > 0);
    for (const id of ["violation-previous", "violation-next", "pulses-violation-previous", "pulses-violation-next"]) {
      /** @type {HTMLButtonElement} */ (byId(id)).disabled = total === 0;
    }
    byId("pulses-violations").hidden = timing === null;
    say(
      byId("pulses-violations-count"),
      total === 0 ? "timing met" : `${count(total)} ${total === 1 ? "violation" : "violations"}`,
    );
    byId("pulses-violations-count").classList.toggle("error", total > 0);
    const example = timing?.rules
      .filter(({ required_ns }) => required_ns > 0)
      .sort((one, other) => rounding(other, clock) - rounding(one, clock))[0];
    say(
      byId("timing-rounding"),
      example
        ? `Slack counts whole cycles of ${at(1)}: what a rule asks for is rounded up to them, as ${si(example.required_ns * 1e-9, "s")} to ${count(example.required_cycles)} cycles = ${at(example.required_cycles)}.`
        : "",
    );
    byId("violations").hidden = total === 0;
    const rows = (timing?.rules ?? []).map(({ rule, required_cycles, required_ns, least, violations }) => {
      const slack = least === null ? null : least.measured_cycles - required_cycles;
      const bad = violations > 0;
      return element(
        "tr",
        bad ? { class: "bad" } : {},
        element("th", { scope: "row" }, ruleButton(rule, bad)),
        ...[
          least ? at(least.measured_cycles) : "–",
          required_ns === 0 ? "–" : si(required_ns * 1e-9, "s"),
          slack === null || required_ns === 0 ? "–" : `${slack < 0 ? "" : "+"}${at(slack)}`,
          bad ? count(violations) : required_ns === 0 ? "–" : "0",
        ].map((text) => element("td", { class: "number" }, text)),
      );
    });
    fill(/** @type {Element} */ (byId("margins").querySelector("tbody")), ...rows);
    fill(
      body,
      ...(timing?.violations ?? []).map(({ cycle, channel, rule, measured_cycles }, index) =>
        element(
          "tr",
          { "data-index": String(index) },
          ...[String(channel), ruleName(rule), time(cycle / clock), at(measured_cycles), required(timing, rule)].map(
            (text, column) => element("td", column === 1 ? {} : { class: "number" }, text),
          ),
        ),
      ),
    );
  }

  /** @param {string} rule @param {boolean} bad */
  function ruleButton(rule, bad) {
    const made = element(
      "button",
      { type: "button", title: bad ? "Show its first violation" : "Show its least margin" },
      ruleName(rule),
    );
    made.addEventListener("click", () => toRule(rule));
    return made;
  }

  /** @param {State} state @param {State | undefined} before */
  function render(state, before) {
    if (before?.result !== state.result) return refresh(state);
    return undefined;
  }
  return { render };
}

/** How much longer than required the whole cycles of a rule are, in s. @param {import("../state/types.js").RuleResult} rule @param {number} clock */
function rounding({ required_ns, required_cycles }, clock) {
  return required_cycles / clock - required_ns * 1e-9;
}

/** The least time that a rule asks for; in cycles it is rounded up. @param {Timing | null} timing @param {string} rule */
export function required(timing, rule) {
  return si((timing?.rules.find((each) => each.rule === rule)?.required_ns ?? 0) * 1e-9, "s");
}
