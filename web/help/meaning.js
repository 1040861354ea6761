/** What a term means, as the cards and the help page have it. */
import { element } from "../dom.js";
import { documents } from "../form/schema.js";

/** What is meant, with where it comes from. @param {"p" | "dd"} tag @param {import("../form/field.js").Term} term */
export function meaning(tag, { text, from }) {
  const document = documents()[from ?? ""];
  return element(tag, {}, text, ...(document ? [" ", element("span", { class: "from" }, `(${document.short})`)] : []));
}
