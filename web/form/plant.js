/** The simulation of motors in the form. */

/** @param {import("./kit.js").Kit} kit @param {import("../state/types.js").Scenario} scenario @returns {Node[]} */
export function plantItems(kit, { plant }) {
  const on = kit.toggle("plant", "Simulate motors", Boolean(plant), kit.samples.plant);
  return [kit.errorOf("plant"), on, ...(plant ? kit.loadItems((parts) => parts.plantFields(kit, plant)) : [])];
}
