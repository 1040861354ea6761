/** The rules of a driver's timing, as the form and the views name them. */

/** By their names in the scenario, without the unit. @type {{[rule: string]: string}} */
export const RULES = {
  step_high: "STEP high",
  step_low: "STEP low",
  dir_setup: "DIR set-up",
  dir_hold: "DIR hold",
  enable_wake: "EN wake-up",
};

/** @param {string} rule */
export function ruleName(rule) {
  return RULES[rule] ?? rule;
}
