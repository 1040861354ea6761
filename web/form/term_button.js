/** A word that explains itself, as the form and the heads of the views have them: the help's card hears its press. */
import { element } from "../dom.js";

/** The id of the card. */
export const CARD = "term-card";

/**
 * The button for a term. In the form it is no stop of the tab key, which would double them: F1 in its field opens it.
 * @param {string} text  What it says.
 * @param {string} term  Its name in `TERMS`, or of a view in `VIEWS` as `view:motion`.
 * @param {{[name: string]: string}} [attributes]
 */
export function termButton(text, term, attributes = {}) {
  return element(
    "button",
    {
      type: "button",
      class: "term",
      "aria-expanded": "false",
      "aria-controls": CARD,
      "data-term": term,
      ...attributes,
    },
    text,
  );
}
