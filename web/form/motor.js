/** The motor of an axis in the form. */
import { element } from "../dom.js";

/** @typedef {import("./kit.js").Kit} Kit */

/** The motor of an axis, or none. @param {Kit} kit @param {string} path  Of the axis. @param {any} axis @param {string} name @returns {Node[]} */
export function motorItems(kit, path, { motor }, name) {
  const at = `${path}.motor`;
  const check = element("input", { type: "checkbox", "data-path": `${at}#kind`, "aria-label": `Motor of ${name}` });
  check.checked = motor !== null;
  check.addEventListener("change", () =>
    kit.change(at, () => (check.checked ? kit.samples.motor : null), [[at, null]]),
  );
  const plant = kit.now().scenario.plant;
  const label = element("label", { class: "check" }, check, plant ? "Motor for this axis" : "Check the motor torque");
  return [
    kit.errorOf(at),
    label,
    ...(motor ? kit.loadItems((parts) => parts.motorFields(kit, at, Boolean(plant), name)) : []),
  ];
}
