/** Motors and their simulation in the form: all data of motors are here. */
import { button, byId } from "../dom.js";
import { motorsOfAxes } from "./motor.js";

/** @param {import("./kit.js").Kit} kit @param {import("../state/types.js").Scenario} scenario @returns {Node[]} */
export function plantItems(kit, scenario) {
  const { plant } = scenario;
  const on = kit.toggle("plant", "Simulate motors", Boolean(plant), kit.samples.plant);
  const choose = button("Choose a motor…", "Choose a motor and a driver from the list in the Motor view", () => {
    kit.dispatch({ type: "view", view: "motor" });
    kit.dispatch({ type: "side", area: "motion", side: "motor" });
    const list = /** @type {HTMLDetailsElement} */ (byId("motor-choice"));
    list.open = true;
    list.scrollIntoView({ block: "nearest" });
  });
  return [
    kit.errorOf("plant"),
    on,
    choose,
    ...motorsOfAxes(kit, scenario),
    ...(plant ? kit.loadItems((parts) => parts.plantFields(kit, plant)) : []),
  ];
}
