/** The text of a term with its source, for the cards and the help page. */
import { element } from "../dom.js";
import { documents } from "../form/schema.js";

/** Text and source of a term. @param {"p" | "dd"} tag @param {import("../form/field.js").Term} term */
export function meaning(tag, { text, from }) {
  const document = documents()[from ?? ""];
  return element(tag, {}, text, ...(document ? [" ", element("span", { class: "from" }, `(${document.short})`)] : []));
}
