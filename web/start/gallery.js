/** The gallery of presets: a dialog with a search, groups, and a thumbnail of each run. */
import { button, element, fill, setText } from "../dom.js";
import { loadExperiments } from "../shell/storage.js";
import { ALL, choicesOf, entriesOf, groupsOf } from "../state/gallery.js";
import { counted } from "../state/number.js";
import { openEntry } from "./opening.js";
import { starterCards } from "./starters.js";
import { THUMBNAILS } from "./thumbnails.js";

const SVG = "http://www.w3.org/2000/svg";

/** @typedef {import("../state/gallery.js").Entry} Entry */

/** Fills the dialog. Returns how to open it. @param {import("./opening.js").Page} page @param {HTMLDialogElement} dialog */
export function createGallery(page, dialog) {
  const search = /** @type {HTMLInputElement} */ (
    element("input", { type: "search", id: "gallery-search", spellcheck: "false", autocomplete: "off" })
  );
  search.placeholder = "Search: spectrum, DRV8825, Zhang";
  const choices = element("div", { class: "group", role: "group", "aria-label": "Groups" });
  const list = element("div", { id: "gallery-list" });
  const found = element("p", { class: "unseen", "aria-live": "polite" });
  const starters = element("div", { class: "cards" });
  let choice = ALL;
  fill(
    dialog,
    element(
      "div",
      { class: "head" },
      element("h2", { id: "gallery-title" }, "Presets"),
      element("label", {}, element("span", { class: "unseen" }, "Search presets"), search),
      button("Close", "Close", () => dialog.close()),
      choices,
    ),
    found,
    starters,
    list,
  );
  fill(starters, ...starterCards(page, () => dialog.close()));
  search.addEventListener("input", show);
  search.addEventListener("keydown", (event) => {
    if (event.key !== "Enter") return;
    event.preventDefault();
    if (search.value.trim()) /** @type {HTMLElement | null} */ (list.querySelector("button"))?.click();
  });

  /** @param {Entry} entry */
  function card(entry) {
    const { id, title, text } = entry;
    const made = element("button", { type: "button", class: "card", "data-entry": id, title: text });
    if (THUMBNAILS[id]) made.append(thumbnail(THUMBNAILS[id]));
    made.append(element("b", {}, title), element("span", {}, text));
    made.addEventListener("click", () => {
      dialog.close();
      openEntry(page, entry);
    });
    if (page.now().origin === `preset:${id}`) made.setAttribute("aria-current", "true");
    return made;
  }

  function show() {
    const entries = entriesOf(page.presets, loadExperiments());
    const groups = groupsOf(entries, choice, search.value);
    starters.hidden = choice !== ALL || search.value !== "";
    for (const each of choices.children) each.setAttribute("aria-pressed", String(each.textContent === choice));
    setText(found, counted(groups.flatMap((group) => group.entries).length, "preset"));
    fill(
      list,
      ...groups.flatMap(({ title, entries }) => [
        element("h3", {}, title),
        element("div", { class: "cards" }, ...entries.map(card)),
      ]),
    );
    if (groups.length === 0) list.append(element("p", { class: "note" }, "Nothing found; use fewer words."));
  }

  return () => {
    search.value = "";
    choice = ALL;
    const named = choicesOf(entriesOf(page.presets, loadExperiments()));
    fill(
      choices,
      ...named.map((name) =>
        button(name, name, () => {
          choice = name;
          show();
        }),
      ),
    );
    show();
    dialog.showModal();
    dialog.scrollTop = 0;
    search.focus();
  };
}

/** @param {string} path */
function thumbnail(path) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 120 40");
  svg.setAttribute("aria-hidden", "true");
  const line = document.createElementNS(SVG, "path");
  line.setAttribute("d", path);
  svg.append(line);
  return svg;
}
