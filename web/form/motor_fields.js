/** The fields of a motor with its supply and load. */
import { fields } from "./schema.js";

/** @typedef {import("./kit.js").Kit} Kit */

/** What the torque hangs on; the rest counts in a plant alone. */
const OF_TORQUE = [
  "rated_current_a",
  "resistance_ohm",
  "inductance_mh",
  "holding_torque_mN_m",
  "rotor_inertia_g_cm2",
  "supply_v",
  "peak_current_a",
  "load_inertia_g_cm2",
  "load_torque_mN_m",
  "working_rate_hz",
];

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
          kit.part(`Driver of ${name}`, false, kit.block(`${at}.driver`, fields("Drive"))),
        ]
      : []),
  ];
}
