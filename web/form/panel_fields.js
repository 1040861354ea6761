/** Fields of stand-alone controllers: warnings, and levels as choices between 0 and 1. */

/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {import("./field.js").Field} Field */

/** What can be selected where the schema has 0 and 1. */
export const CHOICES = { level: { 0: "0", 1: "1" } };

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

/** Fields; a level of 0 or 1 is selected. @param {Kit} kit @param {string} path @param {Field[]} given */
export function choiceBlock(kit, path, given) {
  return kit.block(
    path,
    withWarnings(path, given).map((each) =>
      each.key === "level" ? { ...each, kind: "choice", choices: CHOICES.level } : each,
    ),
  );
}
