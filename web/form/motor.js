/** A motor in the form, with its supply and its load: without one nothing is said of torque, and a plant has the usual one. */
import { element } from "../dom.js";
import { fields } from "./schema.js";

/** @typedef {import("./kit.js").Kit} Kit */

/** What the torque hangs on; the rest counts in a plant alone. */
const OF_TORQUE = [
  "rated_current_a",
  "resistance_ohm",
  "inductance_mh",
  "holding_torque_mn_m",
  "rotor_inertia_g_cm2",
  "supply_v",
  "peak_current_a",
  "load_inertia_g_cm2",
  "load_torque_mn_m",
  "working_rate_hz",
];

/** The motor of an axis, or none. @param {Kit} kit @param {string} path  The axis'. @param {any} axis @param {string} name @returns {Node[]} */
export function motorItems(kit, path, { motor }, name) {
  const at = `${path}.motor`;
  const check = element("input", { type: "checkbox", "data-path": `${at}#kind`, "aria-label": `Motor of ${name}` });
  check.checked = motor !== null;
  check.addEventListener("change", () =>
    kit.change(at, () => (check.checked ? kit.samples.motor : null), [[at, null]]),
  );
  const plant = kit.now().scenario.plant;
  const label = element(
    "label",
    { class: "check" },
    check,
    plant ? "A motor of its own" : "Check the torque of its motor",
  );
  return [kit.errorOf(at), label, ...(motor ? motorFields(kit, at, Boolean(plant), name) : [])];
}

/** The fields of a motor. @param {Kit} kit @param {string} at  Its path. @param {boolean} isDriven  Whether there is a plant. @param {string} name @returns {Node[]} */
export function motorFields(kit, at, isDriven, name) {
  const all = fields("Motor");
  const rest = all.filter(({ key }) => !OF_TORQUE.includes(key));
  return [
    ...kit.block(
      at,
      all.filter(({ key }) => OF_TORQUE.includes(key)),
    ),
    ...(isDriven
      ? [
          kit.part(`Friction and coupling of ${name}`, false, kit.block(at, rest)),
          kit.part(`Driver of ${name}`, false, kit.block(`${at}.drive`, fields("Drive"))),
        ]
      : []),
  ];
}
