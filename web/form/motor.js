/** The motor of an axis in the form, with its supply and its load: without one nothing is said of torque. */
import { element } from "../dom.js";
import { number } from "./field.js";

/** @typedef {import("./field.js").Field} Field */

const SHAFT = "seen from the motor's shaft, 0 to";
/** @type {Field[]} */
const FIELDS = [
  number("rated_current_a", "Rated current", "A", "Of a phase, both on; 0.001 to 100."),
  number("resistance_ohm", "Resistance", "Ω", "Of a phase, 0.001 to 1000."),
  number("inductance_mh", "Inductance", "mH", "Of a phase, 0.001 to 10 000."),
  number("holding_torque_mn_m", "Holding torque", "mN·m", "Both phases at the rated current, 0.001 to 10⁶."),
  number("rotor_inertia_g_cm2", "Rotor inertia", "g·cm²", "0 to 10⁹."),
  number("supply_v", "Supply", "V", "Of the driver, 0.1 to 1000. The document gives none."),
  {
    key: "peak_current_a",
    label: "Peak current",
    unit: "A",
    kind: "optional-number",
    hint: "That the driver regulates, up to 1.41 × the rated; empty for the rated current.",
  },
  number("load_inertia_g_cm2", "Load inertia", "g·cm²", `What turns with the rotor, ${SHAFT} 10⁹.`),
  number("load_torque_mn_m", "Load torque", "mN·m", `What opposes the motion, ${SHAFT} 10⁶.`),
  {
    key: "working_rate_hz",
    label: "Working rate",
    unit: "steps/s",
    kind: "optional-number",
    hint: "Highest rate at which the motor is known to work, 1 to 10⁷; empty where only the torque limits it.",
  },
];

/** @param {import("./kit.js").Kit} kit @param {string} path  The axis'. @param {any} axis @param {string} name @returns {Node[]} */
export function motorItems(kit, path, { motor }, name) {
  const at = `${path}.motor`;
  const check = element("input", { type: "checkbox", "data-path": `${at}#kind`, "aria-label": `Motor of ${name}` });
  check.checked = motor !== null;
  check.addEventListener("change", () => kit.put(at, check.checked ? kit.samples.motor : null));
  const label = element("label", { class: "check" }, check, "Check the torque of its motor");
  return [kit.errorOf(at), label, ...(motor ? kit.block(at, FIELDS) : [])];
}
