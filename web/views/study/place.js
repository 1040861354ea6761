/** Path of the selected axis. */
import { get } from "../../state/paths.js";

/** @typedef {import("../../state/types.js").State} State */

/** The place of the selected axis in the scenario, even with problems in the form; the path is empty if there is none. @param {State} state */
export function place({ scenario, result, axis: selected }) {
  const controller = result?.controller ?? 0;
  const list = controller > 0 ? `controllers[${controller - 1}].axes` : "source.motion.axes";
  const axes = scenario.source?.motion ? (get(scenario, list) ?? []) : [];
  const axis = Math.min(selected, axes.length - 1);
  return { controller, axis, path: axis < 0 ? "" : `${list}[${axis}]`, moves: axes[axis]?.moves };
}
