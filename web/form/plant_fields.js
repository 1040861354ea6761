/** The fields of a plant: supply, sensors, protection and motors. */
import { button } from "../dom.js";
import { motorFields } from "./motor_fields.js";
import { fields, labelOf, maxLengthOf } from "./schema.js";

/** @typedef {import("./kit.js").Kit} Kit */

/** @param {Kit} kit @param {any} plant @returns {Node[]} */
export function plantFields(kit, plant) {
  const group = (/** @type {string} */ name, /** @type {string} */ of) =>
    kit.part(labelOf("PlantSettings", name), false, kit.block(`plant.${name}`, fields(of)));
  const protection = plant.protection ?? null;
  return [
    ...kit.block("plant", fields("PlantSettings")),
    kit.toggle("plant.protection", "Stop at an overload", protection !== null, kit.samples.protection),
    ...(protection ? kit.block("plant.protection", fields("Protection")) : []),
    group("current_sensor", "CurrentSensor"),
    group("encoder", "Encoder"),
    kit.part("Motors of channels without an axis", (plant.motors ?? []).length > 0, motors(kit, plant.motors ?? [])),
  ];
}

/** @param {Kit} kit @param {any[]} list @returns {Node[]} */
function motors(kit, list) {
  const at = "plant.motors";
  return [
    kit.errorOf(at),
    ...list.map((_, index) =>
      kit.item(
        `Motor ${index}`,
        `${at}[${index}]`,
        [
          ...kit.block(`${at}[${index}]`, fields("PlantMotor")),
          ...motorFields(kit, `${at}[${index}].motor`, true, `motor ${index}`),
          button("Remove", `Remove motor ${index}`, () => kit.remove(at, index)),
        ],
        "PlantSettings.motors",
      ),
    ),
    button(
      "Add motor",
      "Add motor",
      () => kit.append(at, (last) => structuredClone(last ?? kit.samples.plant_motor)),
      list.length >= maxLengthOf("PlantSettings", "motors"),
    ),
  ];
}
