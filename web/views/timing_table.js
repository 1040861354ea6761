/** Tables of the timing check: rules and violations. */
import { byId, element, fill, setText } from "../dom.js";
import { ruleName } from "../form/schema.js";
import { count, si, time } from "../state/number.js";
import { required } from "./required.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Timing} Timing */

/** Digits of a measured time. */
const DIGITS = 7;

/** The columns of both tables: headings and their tooltips. @type {{[table: string]: [string, string?][]}} */
const HEADS = {
  margins: [
    ["rule"],
    ["shortest"],
    ["required"],
    ["slack", "Measured time minus required time"],
    ["count", "Violations"],
  ],
  violations: [["ch", "Channel"], ["rule"], ["time"], ["measured"], ["required"]],
};

/**
 * @param {Timing | null} timing  None without a driver.
 * @param {{state: State, drivers: import("../state/types.js").DriverSheet[], showRule: (rule: string) => void}} page
 */
export function paintTiming(timing, { state, drivers, showRule }) {
  const body = /** @type {Element} */ (byId("violations").querySelector("tbody"));
  for (const [table, columns] of Object.entries(HEADS)) fillHead(byId(table), columns);
  const clock = state.result?.summary.clock_hz ?? 1;
  // With all digits, so that the printed times agree with the printed slack.
  const cyclesText = (/** @type {number} */ cycles) => time(cycles / clock);
  const sheet = drivers.find(({ id }) => id === timing?.driver);
  const total = timing?.total ?? 0;
  const listed = timing?.violations.length ?? 0;
  setText(byId("timing-driver"), sheet?.name ?? "custom rules");
  byId("timing-driver").title = sheet?.source ?? "";
  const listNote = total > listed ? `; the first ${count(listed)} are listed` : "";
  setText(
    byId("timing-total"),
    total === 0
      ? "The pulses meet the timing of the data sheet: no violations."
      : `${count(total)} ${total === 1 ? "violation" : "violations"}${listNote}.`,
  );
  byId("timing-total").classList.toggle("error", total > 0);
  for (const id of ["violation-previous", "violation-next", "pulses-violation-previous", "pulses-violation-next"]) {
    /** @type {HTMLButtonElement} */ (byId(id)).disabled = total === 0;
  }
  byId("pulses-violations").hidden = timing === null;
  setText(
    byId("pulses-violations-count"),
    total === 0 ? "timing met" : `${count(total)} ${total === 1 ? "violation" : "violations"}`,
  );
  byId("pulses-violations-count").classList.toggle("error", total > 0);
  const example = timing?.rules
    .filter(({ required_ns }) => required_ns > 0)
    .sort((one, other) => rounding(other, clock) - rounding(one, clock))[0];
  setText(
    byId("timing-rounding"),
    example
      ? `Pulse times are whole cycles of ${cyclesText(1)}: ${time(example.required_ns * 1e-9)} needs at least ${count(example.required_cycles)} cycles (${cyclesText(example.required_cycles)}).`
      : "",
  );
  byId("violations").hidden = total === 0;
  const rows = (timing?.rules ?? []).map(({ rule, required_ns, shortest, violations }) => {
    // From the printed digits, so that the columns agree.
    const slack = shortest && Number((shortest.measured_cycles / clock).toPrecision(DIGITS)) - required_ns * 1e-9;
    const isViolated = violations > 0;
    return element(
      "tr",
      isViolated ? { class: "bad" } : {},
      element("th", { scope: "row" }, ruleButton(rule, isViolated, showRule)),
      ...[
        shortest ? cyclesText(shortest.measured_cycles) : "–",
        required_ns === 0 ? "–" : time(required_ns * 1e-9),
        slack === null || required_ns === 0 ? "–" : `${slack < 0 ? "" : "+"}${si(slack, "s", DIGITS + 2)}`,
        isViolated ? count(violations) : required_ns === 0 ? "–" : "0",
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
        ...[
          String(channel),
          ruleName(rule),
          time(cycle / clock),
          cyclesText(measured_cycles),
          required(timing, rule),
        ].map((text, column) => element("td", column === 1 ? {} : { class: "number" }, text)),
      ),
    ),
  );
}

/** @param {HTMLElement} table @param {[string, string?][]} columns */
function fillHead(table, columns) {
  const head = /** @type {Element} */ (table.querySelector("thead"));
  if (head.firstChild) return;
  const cells = columns.map(([text, title]) => {
    const cell = element("th", { scope: "col", ...(text === "rule" ? {} : { class: "number" }) }, text);
    if (title) cell.title = title;
    if (text === "ch") cell.setAttribute("aria-label", "Channel");
    return cell;
  });
  head.append(element("tr", {}, ...cells));
}

/** @param {string} rule @param {boolean} isViolated @param {(rule: string) => void} showRule */
function ruleButton(rule, isViolated, showRule) {
  const made = element(
    "button",
    { type: "button", title: isViolated ? "Show the first violation" : "Show the smallest slack" },
    ruleName(rule),
  );
  made.addEventListener("click", () => showRule(rule));
  return made;
}

/** The difference between the whole cycles of a rule and its required time, in s. @param {import("../state/types.js").RuleResult} rule @param {number} clock */
function rounding({ required_ns, required_cycles }, clock) {
  return required_cycles / clock - required_ns * 1e-9;
}
