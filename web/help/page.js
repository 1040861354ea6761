/** The help page: its lists are those that the page itself uses. */
import { byId, element, fill } from "../dom.js";
import { MECHANICS } from "../form/fields.js";
import { MOVES } from "../form/moves/index.js";
import { meaning } from "./card.js";
import { termsOf } from "./terms.js";
import * as texts from "./texts.js";

const { DOCUMENTS, VIEWS } = texts;
const TERMS = termsOf(texts);

fill(
  byId("moves"),
  ...Object.values(MOVES).flatMap(({ label, about }) => [element("dt", {}, label), meaning("dd", about, DOCUMENTS)]),
);
fill(
  byId("mechanics"),
  ...Object.values(MECHANICS).flatMap(({ label, about }) => [
    element("dt", {}, label),
    meaning("dd", about, DOCUMENTS),
  ]),
);
fill(
  byId("view-list"),
  ...Object.entries(VIEWS).flatMap(([view, { about }]) => [
    element("dt", {}, view === "timing" ? "Driver timing" : view[0].toUpperCase() + view.slice(1)),
    element("dd", {}, about),
  ]),
);
fill(byId("documents"), ...Object.values(DOCUMENTS).map(({ title }) => element("li", {}, title)));

// Two terms can have one name, such as the width of a pulse and the rule for it.
const kinds = new Set(Object.keys({ ...MOVES, ...MECHANICS }));
const terms = Object.entries(TERMS)
  .filter(([id]) => !kinds.has(id))
  .map(([, term]) => term);
terms.sort((a, b) => (a.name ?? "").localeCompare(b.name ?? "", "en"));
fill(byId("terms"), ...terms.flatMap((term) => [element("dt", {}, term.name ?? ""), meaning("dd", term, DOCUMENTS)]));
