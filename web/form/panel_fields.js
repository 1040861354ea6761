/** Fields of stand-alone controllers: warnings, and levels as choices between 0 and 1. */
import { withLabels } from "./schema.js";

/** @typedef {import("./kit.js").Kit} Kit */
/** @typedef {import("./field.js").Field} Field */

/** Choices for fields whose schema has 0 and 1. */
export const CHOICES = { level: { 0: "0", 1: "1" } };

/** Adds the warnings of the validation to fields. @param {string} path @param {Field[]} fields @returns {Field[]} */
export function withWarnings(path, fields) {
  return fields.map((each) => ({
    ...each,
    also: (value, state) => {
      const at = `${path}.${each.key}`;
      const warning = state.validation?.warnings.find((/** @type {{path: string}} */ one) => one.path === at);
      return warning ? withLabels(warning.message) : (each.also?.(value, state) ?? "");
    },
  }));
}

/** A block in which a level of 0 or 1 is a choice. @param {Kit} kit @param {string} path @param {Field[]} fields */
export function choiceBlock(kit, path, fields) {
  return kit.block(
    path,
    withWarnings(path, fields).map((each) =>
      each.key === "level" ? { ...each, kind: "choice", choices: CHOICES.level } : each,
    ),
  );
}
