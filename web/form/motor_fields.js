/** The fields of a motor with its supply and load. */
import { fields } from "./schema.js";

/** @typedef {import("./kit.js").Kit} Kit */

/** Fields that affect the torque-speed curve; the others only affect a simulated motor. */
const TORQUE_FIELDS = [
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

/** The fields of a motor. @param {Kit} kit @param {string} at  Its path. @param {boolean} isSimulated @param {string} name @returns {Node[]} */
export function motorFields(kit, at, isSimulated, name) {
  const all = fields("Motor");
  const simulationFields = all.filter(({ key }) => !TORQUE_FIELDS.includes(key));
  return [
    ...kit.block(
      at,
      all.filter(({ key }) => TORQUE_FIELDS.includes(key)),
    ),
    ...(isSimulated
      ? [
          kit.part(`Friction and coupling of ${name}`, false, kit.block(at, simulationFields)),
          kit.part(`Driver of ${name}`, false, kit.block(`${at}.driver`, fields("Drive"))),
        ]
      : []),
  ];
}
