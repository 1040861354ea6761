/** The motor of an axis in the form. */
import { element } from "../dom.js";

/** @typedef {import("./kit.js").Kit} Kit */

/** The motors of all axes. @param {Kit} kit @param {import("../state/types.js").Scenario} scenario @returns {Node[]} */
export function motorsOfAxes(kit, { source, controllers }) {
  const lists = [
    { path: "source.motion.axes", axes: source.motion?.axes ?? [], suffix: "" },
    ...controllers.map((/** @type {any} */ { axes }, /** @type {number} */ index) => ({
      path: `controllers[${index}].axes`,
      axes: axes ?? [],
      suffix: ` of controller ${index + 2}`,
    })),
  ];
  return lists.flatMap(({ path, axes, suffix }) =>
    axes.flatMap((/** @type {any} */ axis, /** @type {number} */ index) =>
      motorItems(kit, `${path}[${index}].motor`, axis.motor, `axis ${index}${suffix}`),
    ),
  );
}

/** The motor of an axis, or none. @param {Kit} kit @param {string} at  Its path. @param {any} motor @param {string} name @returns {Node[]} */
function motorItems(kit, at, motor, name) {
  const check = element("input", { type: "checkbox", "data-path": `${at}#kind`, "aria-label": `Motor of ${name}` });
  check.checked = motor !== null;
  check.addEventListener("change", () =>
    kit.change(at, () => (check.checked ? kit.samples.motor : null), [[at, null]]),
  );
  const isSimulated = Boolean(kit.now().scenario.plant);
  return [
    kit.errorOf(at),
    element("label", { class: "check" }, check, `${isSimulated ? "Motor" : "Check the motor torque"} of ${name}`),
    ...(motor ? kit.loadItems((parts) => parts.motorFields(kit, at, isSimulated, name)) : []),
  ];
}
