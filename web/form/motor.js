/** The motor of an axis in the form, with its supply and its load: without one nothing is said of torque. */
import { element } from "../dom.js";
import { fields } from "./schema.js";

/** @param {import("./kit.js").Kit} kit @param {string} path  The axis'. @param {any} axis @param {string} name @returns {Node[]} */
export function motorItems(kit, path, { motor }, name) {
  const at = `${path}.motor`;
  const check = element("input", { type: "checkbox", "data-path": `${at}#kind`, "aria-label": `Motor of ${name}` });
  check.checked = motor !== null;
  check.addEventListener("change", () =>
    kit.change(at, () => (check.checked ? kit.samples.motor : null), [[at, null]]),
  );
  const label = element("label", { class: "check" }, check, "Check the torque of its motor");
  return [kit.errorOf(at), label, ...(motor ? kit.block(at, fields("Motor")) : [])];
}
