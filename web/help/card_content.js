/** The content of a help card. */
import { element, fill } from "../dom.js";
import { setExplanations, termOf } from "../form/schema.js";
import { VIEWS } from "../state/views.js";
import { meaning } from "./meaning.js";

/** Loads the texts of fields. If that fails, the card shows the hint of the field. */
async function loadExplanations() {
  const found = await import("./explained.js").catch(() => null);
  if (found) setExplanations(found.EXPLAINED);
}

/** Texts of terms without a field. @type {Promise<typeof import("./term_texts.js")> | null} */
let loading = null;

/** Loads them once; null if that fails. */
async function load() {
  loading ??= import("./term_texts.js");
  return loading.catch(() => {
    loading = null;
    return null;
  });
}

/** Fills the card for a word. @param {HTMLElement} card @param {HTMLElement} word @param {() => boolean} isWanted  Whether no other term was requested meanwhile. */
export async function fillCard(card, word, isWanted) {
  const name = word.dataset.term ?? "";
  if (termOf(name)) await loadExplanations();
  const own = termOf(name); // now with its explanation
  const texts = own ? null : await load();
  if (!isWanted()) return;
  const view = VIEWS.find((each) => name === `view:${each.name}`);
  const term = own ?? texts?.DERIVED[name];
  const hint = word.closest(".field")?.querySelector(".hint")?.textContent;
  fill(
    card,
    ...(view && texts
      ? [
          element("p", {}, view.about),
          element(
            "dl",
            {},
            ...Object.values(texts.TERMS[view.name] ?? {}).flatMap((term) => [
              element("dt", {}, term.name ?? ""),
              meaning("dd", term),
            ]),
          ),
        ]
      : [
          element("strong", {}, term?.name ?? word.textContent ?? ""),
          meaning("p", term ?? { text: texts ? "" : "The text could not be loaded. Check the network and try again." }),
          ...(hint ? [element("p", { class: "range" }, hint)] : []),
        ]),
  );
}
