/** The driver that the pulses are checked against, in the form: none, one whose data sheet is known, or rules. */
import { element } from "../dom.js";
import { si } from "../state/number.js";
import { RULES } from "../state/rules.js";
import { RULE_FIELDS } from "./fields.js";

/** @typedef {import("../state/types.js").DriverSheet} DriverSheet */

/** @param {import("./kit.js").Kit} kit @param {import("../state/types.js").Scenario} scenario @param {DriverSheet[]} sheets @returns {Node[]} */
export function driverItems(kit, { driver_timing: driver }, sheets) {
  const known = sheets.find(({ id }) => id === driver?.preset);
  const kinds = {
    none: "not checked",
    ...Object.fromEntries(sheets.map(({ id, name }) => [id, name])),
    rules: "rules of your own",
  };
  const chosen = driver?.rules ? "rules" : (driver?.preset ?? "none");
  const select = kit.kindSelect("Driver", "driver_timing", chosen, kinds, (kind) =>
    kit.put(
      "driver_timing",
      kind === "none"
        ? null
        : // Rules of one's own begin with those of the driver that was chosen.
          kind === "rules"
          ? { rules: { ...kit.samples.rules, ...known?.rules } }
          : { preset: kind },
    ),
  );
  const head = [kit.errorOf("driver_timing"), element("div", { class: "item-head" }, select)];
  if (driver?.rules) return [...head, ...kit.block("driver_timing.rules", RULE_FIELDS)];
  return known ? [...head, element("p", { class: "item-note" }, summary(known))] : head;
}

/** What a driver asks for, and where that stands. @param {DriverSheet} sheet */
function summary({ rules, source }) {
  const times = Object.entries(RULES).flatMap(([rule, label]) => {
    const ns = rules[`${rule}_ns`];
    return ns ? [`${label} ${si(ns * 1e-9, "s")}`] : [];
  });
  return `At least: ${times.join(", ")}. ${source[0].toUpperCase()}${source.slice(1)}.`;
}
