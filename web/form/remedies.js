/** Problems of a run that one click can fix. One function per cause. */
import { button, byId, element, fill } from "../dom.js";
import { readJson } from "../state/json.js";
import { count, pretty, time } from "../state/number.js";
import { set } from "../state/paths.js";
import { isStale } from "../state/queries.js";
import { hasNoLine } from "./source_kinds.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {import("../state/types.js").Scenario} Scenario */
/** @typedef {import("../state/types.js").DriverSheet} DriverSheet */
/** @typedef {{wrong: string, why: string, change: string, scenario: Scenario}} Remedy  The problem, its cause, the change, and the changed scenario. */

/** @param {State} state @param {DriverSheet[]} sheets @param {(scenario: Scenario) => void} apply */
export function showRemedy(state, sheets, apply) {
  const root = byId("remedy");
  const fresh = state.result !== null && !isStale(state) && state.validated === state.revision;
  const remedy = fresh ? (timingViolations(state, sheets) ?? lostSteps(state)) : null;
  root.hidden = remedy === null;
  if (!remedy) return fill(root);
  fill(
    root,
    element("h2", {}, remedy.wrong),
    element("p", {}, remedy.why),
    fixButton(remedy.change, () => apply(remedy.scenario)),
  );
}

/**
 * Offers changes for a motion that is too fast for its bus.
 * @param {(json: string | null) => Promise<{wrong: string, offers: {change: string, scenario: string}[]} | null>} request
 * @param {() => State} now @param {(scenario: Scenario) => void} apply @param {() => Promise<void>} released  Waits until the pointer is released, so that nothing moves under it.
 */
export async function showOffers(request, now, apply, released) {
  const { revision, scenario, validation, drafts } = now();
  const root = byId("offers");
  const isInvalid = (validation?.problems.length ?? 0) > 0 && Object.keys(drafts).length === 0;
  // The current offers are for an earlier scenario.
  for (const press of root.querySelectorAll("button")) press.disabled = true;
  const found = await request(isInvalid ? JSON.stringify(scenario) : null);
  await released();
  const isCurrent = () => now().revision === revision;
  if (!isCurrent()) return;
  root.hidden = !found;
  if (!found) return fill(root);
  fill(
    root,
    element("h2", {}, pretty(found.wrong)),
    ...found.offers.map(({ change, scenario }) =>
      element(
        "p",
        {},
        fixButton(change, () => isCurrent() && apply(readJson(scenario))),
      ),
    ),
  );
}

/** A button that names its effect. @param {string} change @param {() => void} apply */
const fixButton = (change, apply) => button(`Fix it: ${change}`, `Fix it: ${change}`, apply);

/** Pulses that violate the driver timing: use the minimum times of the violated rules. @param {State} state @param {DriverSheet[]} sheets @returns {Remedy | null} */
function timingViolations({ scenario, result }, sheets) {
  const { driver_timing: driver, clock_hz: clock, controllers } = scenario;
  const sheet = sheets.find(({ id }) => id === driver?.preset);
  const rules = driver?.rules ?? sheet?.rules;
  if (!rules) return null;
  const violating = (result?.summary.controllers ?? []).flatMap(({ violations }, index) => (violations ? [index] : []));
  let fixed = scenario;
  const changes = [];
  const wrongs = [];
  for (const index of violating) {
    const path = index === 0 ? "bus" : `controllers[${index - 1}].bus`;
    const bus = index === 0 ? scenario.bus : controllers[index - 1].bus;
    const violated = result?.summary.controllers[index].violated ?? [];
    // A longer pulse shortens the low time, even if that is not violated yet.
    const isWider = violated.includes("step_high");
    const minCycles = (/** @type {string} */ rule) =>
      violated.includes(rule) || (rule === "step_low" && isWider)
        ? Math.ceil(((rules[`${rule}_ns`] ?? 0) * clock) / 1e9)
        : 0;
    const required = requiredTimes(bus, minCycles, hasNoLine(scenario));
    for (const [key, [name, needed]] of Object.entries(required)) {
      if (needed <= bus[key]) continue;
      fixed = set(fixed, `${path}.${key}`, needed);
      changes.push(`${name} to ${count(needed)} cycles${controllers.length ? ` on controller ${index + 1}` : ""}`);
      wrongs.push(
        `${name} is ${time(bus[key] / clock)} and needs at least ${count(needed)} cycles (${time(needed / clock)})`,
      );
    }
  }
  if (changes.length === 0) return null;
  return {
    wrong: "The pulses do not meet the driver’s timing",
    why: `${sheet?.name ?? "The driver"}: ${[...new Set(wrongs)].join("; ")}. A driver can miss a short pulse. A pulse too soon after DIR can step in the old direction.`,
    change: `set ${changes.join(", ")}`,
    scenario: fixed,
  };
}

/** Label and required cycles of each time of a bus. @param {any} bus @param {(rule: string) => number} minCycles @param {boolean} isLineless @returns {{[key: string]: [string, number]}} */
function requiredTimes(bus, minCycles, isLineless) {
  const width = Math.max(bus.pulse_width_cycles, minCycles("step_high"));
  const setup = Math.max(bus.dir_setup_cycles, minCycles("dir_setup"));
  const hold = Math.max(bus.dir_hold_cycles, minCycles("dir_hold") - width);
  const times = {
    pulse_width_cycles: ["STEP high", width],
    dir_setup_cycles: ["DIR set-up", setup],
    dir_hold_cycles: ["DIR hold after STEP falls", hold],
  };
  if (isLineless) return /** @type {any} */ (times);
  // All pulses of a slot must fit into it.
  const pulse = width + Math.max(setup + hold, 1);
  const pulsesPerSlot = bus.pulse_phasing === "staggered" ? bus.channels : bus.dir_line === "common" ? 2 : 1;
  const slot = Math.max(bus.step_period_cycles, pulse * pulsesPerSlot, width + minCycles("step_low"));
  return /** @type {any} */ ({
    ...times,
    step_period_cycles: ["Slot", slot],
    self_test_cycles: ["Self-test", Math.max(bus.self_test_cycles, minCycles("enable_wake"))],
  });
}

/** Steps lost on a noisy line with raw packets: use frames, which are repeated. @param {State} state @returns {Remedy | null} */
function lostSteps({ scenario, derived, result }) {
  const { line, source, run_cycles } = scenario;
  const isDisturbed =
    line.glitches.length > 0 || Object.entries(line.noise).some(([key, value]) => key !== "seed" && value !== 0);
  if (line.protocol !== "raw" || !source.motion || hasNoLine(scenario) || run_cycles !== null || !isDisturbed)
    return null;
  const several = scenario.controllers.length > 0;
  const missed = (derived?.controllers ?? []).flatMap(({ axes }, controller) =>
    axes.flatMap(({ steps }, axis) => {
      const position = result?.summary.controllers[controller]?.positions[axis];
      return position === undefined || position === steps
        ? []
        : [
            `axis ${axis}${several ? ` of controller ${controller + 1}` : ""} ended at step ${count(position)}, not ${count(steps)}`,
          ];
    }),
  );
  if (missed.length === 0) return null;
  return {
    wrong: "Steps were lost on the line",
    why: `${missed[0][0].toUpperCase()}${missed.join("; ").slice(1)}. Raw packets have no checksum and are not repeated, so errors move the motors or lose steps.`,
    change: "use the framed protocol",
    scenario: set(scenario, "line.protocol", "framed"),
  };
}
