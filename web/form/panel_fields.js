/** Fields of stand-alone controllers: warnings, and choices between 0 and 1. */

/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {import("./field.js").Field} Field */

/** What can be selected where the schema has 0 and 1. */
export const CHOICES = {
  direction: { 1: "1 (right)", 0: "0 (left)" },
  level: { 0: "0", 1: "1" },
};

/** Fields with the warning of a value that is valid but may not be meant. @param {string} path @param {Field[]} given @returns {Field[]} */
export function withWarnings(path, given) {
  return given.map((each) => ({
    ...each,
    also: (value, state) => {
      const at = `${path}.${each.key}`;
      const warning = state.validation?.warnings.find((/** @type {{path: string}} */ one) => one.path === at);
      return warning?.message ?? each.also?.(value, state) ?? "";
    },
  }));
}

/** Fields of which those that are 0 or 1 are selected. @param {Kit} kit @param {string} path @param {Field[]} given @param {string[]} [keys]  Which those are; of jog, return and moves the level is an acceleration. */
export function choiceBlock(
  kit,
  path,
  given,
  keys = /jog$|return$/.test(path) ? ["direction"] : ["direction", "level"],
) {
  return kit.block(
    path,
    withWarnings(path, given).map((each) =>
      keys.includes(each.key) && each.key in CHOICES
        ? { ...each, kind: "choice", choices: CHOICES[/** @type {keyof typeof CHOICES} */ (each.key)] }
        : each,
    ),
  );
}
