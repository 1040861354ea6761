/** A button for a term of the form or of a view's header; help/card.js opens its help card. */
import { element } from "../dom.js";

/** The id of the card. */
export const CARD = "term-card";

/**
 * The button of a term. In the form it is not reachable with Tab, which would double the stops; F1 in the field opens the card.
 * @param {string} text
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
