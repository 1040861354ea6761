/** Required times of timing rules. */
import { si } from "../state/number.js";

/** The time that a rule requires. @param {import("../state/types.js").Timing | null} timing @param {string} rule */
export function required(timing, rule) {
  return si((timing?.rules.find((each) => each.rule === rule)?.required_ns ?? 0) * 1e-9, "s");
}
