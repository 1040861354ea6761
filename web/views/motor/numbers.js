/** The table of motor numbers and energies. */
import { element, fill } from "../../dom.js";
import { short, si } from "../../state/number.js";

/** Names of the core (`PlantReport`). @typedef {{channel: number, verdict: string, slips: number, [number: string]: any}} Motor */
/**
 * @typedef {{plant: {digest: string, load_least_a: number, load_greatest_a: number, load_rms_a: number, deviation_above_a: number | null,
 *   deviation_below_a: number | null, bus_least_v: number, bus_greatest_v: number, collapsed_at_s: number | null, overload_cycle: number | null},
 *   motors: Motor[], slips: {channel: number, cycle: number, behind: boolean}[], self_test: {channel: number, settling_cycles: number | null}[]}} Report
 */

const steps = (/** @type {number | null} */ value) => (value === null ? "–" : `${short(value, 5)} full steps`);
const joules = (/** @type {number} */ value) => si(value, "J", 4);
const amperes = (/** @type {number} */ value) => si(value, "A", 4);
const seconds = (/** @type {number | null} */ value) => (value === null ? "–" : si(value, "s", 4));

/** @type {[string, string, (value: any) => string][]} */
const ROWS = [
  ["Final commanded position", "command_full_steps", steps],
  ["Final rotor position", "rotor_full_steps", steps],
  ["Lost", "lost_full_steps", steps],
  ["Number of slips (four full steps each)", "slips", String],
  ["Maximum following error", "following_error_full_steps", steps],
  ["at time", "following_error_at_s", seconds],
  ["Maximum speed", "fastest_full_steps_s", (value) => `${short(value, 5)} full steps/s`],
  ["Overshoot after the last step", "overshoot_full_steps", steps],
  ["Settling time (0.05 full steps)", "settling_s", seconds],
  ["Peak phase current", "phase_peak_a", amperes],
  ["RMS phase current", "phase_rms_a", amperes],
  ["Energy from the bus", "bus_j", joules],
  ["copper losses", "copper_j", joules],
  ["friction", "friction_j", joules],
  ["viscous friction", "viscous_j", joules],
  ["diode losses", "diodes_j", joules],
  ["load", "load_j", joules],
  ["stored energy", "stored_j", joules],
  ["energy balance error", "energy_error", (value) => `${short(100 * value, 3)} %`],
];

/** @param {HTMLElement} root @param {Report} report @param {number} clock */
export function showNumbers(root, { plant, motors, self_test }, clock) {
  const cell = (/** @type {string} */ text) => element("td", { class: "number" }, text);
  const row = (/** @type {string} */ name, /** @type {string[]} */ cells) =>
    element("tr", {}, element("th", { scope: "row" }, name), ...cells.map(cell));
  const settlingTimes = self_test.map(({ settling_cycles: cycles }) =>
    cycles === null ? "does not settle" : si(cycles / clock, "s"),
  );
  const table = element(
    "table",
    { "aria-label": "Results of the motors" },
    element(
      "thead",
      {},
      element(
        "tr",
        {},
        element("th", { scope: "col" }, `plant digest ${plant.digest}`),
        ...motors.map(({ channel }) => element("th", { scope: "col", class: "number" }, `motor ${channel}`)),
      ),
    ),
    element(
      "tbody",
      {},
      ...ROWS.map(([name, key, print]) =>
        row(
          name,
          // After lost steps the overshoot is meaningless.
          motors.map((motor) => (key === "overshoot_full_steps" && motor.slips > 0 ? "–" : print(motor[key]))),
        ),
      ),
      ...(settlingTimes.length > 0 ? [row("Settling time of the self-test", settlingTimes)] : []),
      ...(plant.deviation_above_a === null
        ? []
        : [
            row("Supply current above idle, at the sensor", [amperes(plant.deviation_above_a)]),
            row("Supply current below idle, at the sensor", [amperes(plant.deviation_below_a ?? 0)]),
          ]),
    ),
  );
  fill(root, table);
}
