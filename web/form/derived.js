/** Shows the name and note of the scenario, and its derived values. */
import { byId, drawInPlace, element, fill, flash, setText } from "../dom.js";
import { derivedShown } from "../state/queries.js";
import { derivedRows, moveNote } from "./derived_rows.js";
import { documents } from "./schema.js";
import { termButton } from "./term_button.js";

/** @typedef {import("../state/types.js").State} State */

/** A note with links to the papers that it cites. @param {string} note @returns {(Node | string)[]} */
function noteNodes(note) {
  const papers = Object.entries(documents());
  const patterns = papers.map(([, { short }]) => short.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
  const parts = patterns.length > 0 ? note.split(new RegExp(`(${patterns.join("|")})`)) : [note];
  return parts.map((part) => {
    const [id, paper] = papers.find(([, { short }]) => short === part) ?? [];
    return paper ? element("a", { href: `help.html#paper-${id}`, target: "_blank", title: paper.title }, part) : part;
  });
}

/** Name and note of the scenario. @param {State} state */
export function showAbout({ scenario }) {
  const root = byId("about");
  root.hidden = !scenario.title && !scenario.note;
  setText(/** @type {Element} */ (root.querySelector("h2")), String(scenario.title ?? ""));
  const note = /** @type {Element} */ (root.querySelector("p"));
  if (note.textContent !== scenario.note) fill(note, ...noteNodes(String(scenario.note ?? "")));
}

const OF_LAST_RUN = "From the last run; the form has errors";

/** @param {State} state @param {HTMLElement} form @param {boolean} [inPlace]  Whether the layout must not change. */
export function showDerived(state, form, inPlace = false) {
  const root = byId("derived");
  const { derived, fresh } = derivedShown(state);
  root.classList.toggle("stale", !fresh);
  root.title = fresh ? "" : OF_LAST_RUN;
  const rows = derived ? derivedRows(state, derived) : [];
  const terms = [...root.querySelectorAll("dt")];
  if (rows.length !== terms.length || rows.some(([name], index) => terms[index].textContent !== name)) {
    if (inPlace) return;
    fill(
      root,
      element(
        "dl",
        {},
        ...rows.map(([name, value, mark, term]) =>
          element("div", {}, element("dt", {}, termButton(name, term)), element("dd", { class: mark }, value)),
        ),
      ),
    );
  } else {
    for (const [index, value] of [...root.querySelectorAll("dd")].entries()) {
      const [, text, mark] = rows[index];
      value.classList.toggle("over", mark === "over");
      if (value.textContent === text) continue;
      if (inPlace) drawInPlace(root, value, () => setText(value, text));
      else setText(value, text);
      flash(value);
    }
  }
  for (const note of /** @type {NodeListOf<HTMLElement>} */ (form.querySelectorAll("[data-note]"))) {
    const { text, warning } = moveNote(note.dataset.note ?? "", { ...state, derived });
    note.classList.toggle("stale", !fresh);
    note.title = fresh ? "" : OF_LAST_RUN;
    const show = () => fill(note, text, ...(warning ? [element("strong", { class: "short" }, warning)] : []));
    if (note.textContent === text + warning) continue;
    if (inPlace) drawInPlace(note, note, show);
    else show();
  }
}
