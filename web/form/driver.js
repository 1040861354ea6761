/** The driver of the timing check: none, a known one, or custom rules. */
import { element } from "../dom.js";
import { si } from "../state/number.js";
import { fields, labelOf } from "./schema.js";

/** @typedef {import("../state/types.js").DriverSheet} DriverSheet */

/** @param {import("./kit.js").Kit} kit @param {import("../state/types.js").Scenario} scenario @param {DriverSheet[]} sheets @returns {Node[]} */
export function driverItems(kit, { driver_timing: driver }, sheets) {
  const known = sheets.find(({ id }) => id === driver?.preset);
  const kinds = {
    none: "not checked",
    ...Object.fromEntries(sheets.map(({ id, name }) => [id, name])),
    rules: labelOf("DriverTiming", "rules"),
  };
  const selected = driver?.rules ? "rules" : (driver?.preset ?? "none");
  const select = kit.kindSelect("Driver", "driver_timing", selected, kinds, (kind) =>
    kit.change(
      "driver_timing",
      () =>
        kind === "none"
          ? null
          : // Custom rules start with the selected driver's rules.
            kind === "rules"
            ? { rules: { ...kit.samples.rules, ...known?.rules } }
            : { preset: kind },
      [["driver_timing", null]],
    ),
  );
  const head = [kit.errorOf("driver_timing"), element("div", { class: "item-head" }, select)];
  if (driver?.rules) return [...head, ...kit.block("driver_timing.rules", fields("TimingRules"))];
  return known ? [...head, element("p", { class: "item-note" }, summary(known))] : head;
}

/** The requirements of a driver and their source. @param {DriverSheet} sheet */
function summary({ rules, source }) {
  const times = fields("TimingRules").flatMap(({ key, label }) => {
    const ns = rules[key];
    return ns ? [`${label} ${si(ns * 1e-9, "s")}`] : [];
  });
  return `Minimum times: ${times.join(", ")}. ${source[0].toUpperCase()}${source.slice(1)}.`;
}
