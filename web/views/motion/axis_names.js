/** What distinguishes the axes in the legend. */
import { field, labels } from "../../form/schema.js";
import { get } from "../../state/paths.js";

/** The kind or shape of each axis with a single move; empty if all are the same. @param {import("../../state/types.js").State} state @returns {string[]} */
export function axisNames({ scenario, result }) {
  const controller = result?.controller ? `controllers[${result.controller - 1}]` : "source.motion";
  const axes = get(scenario, `${controller}.axes`) ?? [];
  const names = axes.map((/** @type {any} */ { moves }) => {
    if (moves?.length !== 1) return "";
    const [[kind, { shape }]] = /** @type {[string, any][]} */ (Object.entries(moves[0]));
    return (kind === "ramps" ? field("Ramps", "shape").choices?.[shape] : labels("Move")[kind]) ?? "";
  });
  return new Set(names).size > 1 ? names : [];
}
