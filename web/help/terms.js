/** Every term: those of the texts, and those that stand with the form: of a source, a kind of move or of mechanics. */
import { MECHANICS } from "../form/fields.js";
import { MOVES } from "../form/moves/index.js";
import { SOURCE_TERMS } from "../form/source_terms.js";

/** @typedef {import("../form/field.js").Term} Term */

/** All of them by their ids: fields' by `term` or `key`. @param {typeof import("./texts.js")} texts @returns {{[id: string]: Term}} */
export function termsOf({ COMMON, VIEWS }) {
  return {
    ...COMMON,
    ...SOURCE_TERMS,
    ...Object.fromEntries(
      Object.entries({ ...MECHANICS, ...MOVES }).map(([kind, { label, about }]) => [kind, { name: label, ...about }]),
    ),
    ...Object.assign({}, ...Object.values(MOVES).map(({ terms }) => terms)),
    ...Object.assign({}, ...Object.values(VIEWS).map(({ terms }) => terms)),
  };
}
