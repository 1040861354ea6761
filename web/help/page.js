/** Fills the lists of the help page. */
import { byId, element, fill } from "../dom.js";
import { compiled } from "../engine/wasm.js";
import { documents, labels, setExplanations, setSchema, termOf, terms } from "../form/schema.js";
import init, { schema } from "../pkg/stepscope_wasm.js";
import { VIEWS } from "../state/views.js";
import { EXPLAINED } from "./explained.js";
import { meaning } from "./meaning.js";
import { DERIVED, TERMS } from "./term_texts.js";

/** @typedef {import("../form/field.js").Term} Term */

await init({ module_or_path: await compiled() });
setSchema(schema());
setExplanations(EXPLAINED);

/** The kinds of a choice with their meaning. @param {string} group */
const kinds = (group) =>
  Object.entries(labels(group)).flatMap(([kind, label]) => [
    element("dt", {}, label),
    meaning("dd", /** @type {Term} */ (termOf(`${group}.${kind}`))),
  ]);

fill(byId("moves"), ...kinds("Move"));
fill(byId("mechanics"), ...kinds("Mechanics"));
fill(byId("view-list"), ...VIEWS.flatMap(({ title, about }) => [element("dt", {}, title), element("dd", {}, about)]));
fill(
  byId("documents"),
  ...Object.entries(documents()).map(([id, { title }]) => element("li", { id: `paper-${id}` }, title)),
);

// Several groups share terms, and two terms can have the same name.
const fieldTerms = Object.entries(terms()).filter(([id]) => !/^(Move|Mechanics)\./.test(id));
const viewTerms = Object.values(TERMS).flatMap((terms) => Object.values(terms));
const allTerms = [...fieldTerms.map(([, term]) => term), ...Object.values(DERIVED), ...viewTerms];
const unique = [...new Map(allTerms.map((term) => [`${term.name}: ${term.text}`, term])).values()];
unique.sort((a, b) => (a.name ?? "").localeCompare(b.name ?? "", "en"));
fill(byId("terms"), ...unique.flatMap((term) => [element("dt", {}, term.name ?? ""), meaning("dd", term)]));

// The lists were empty when the browser looked for the target of the link.
if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();
