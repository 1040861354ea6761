/** What a card says of its word. */
import { element, fill } from "../dom.js";
import { takeExplanations, termOf } from "../form/schema.js";
import { VIEWS } from "../state/views.js";
import { meaning } from "./meaning.js";

/** Loads what the terms of fields mean; where that fails their fields' own text stands for it, and the next card asks again. */
async function explained() {
  const found = await import("./explained.js").catch(() => null);
  if (found) takeExplanations(found.EXPLAINED);
}

/** What the cards say of no field. @type {Promise<typeof import("./texts.js")> | null} */
let loading = null;

/** Loads it, once; null where that fails. */
async function load() {
  loading ??= import("./texts.js");
  return loading.catch(() => {
    loading = null;
    return null;
  });
}

/** Fills the card for a word. @param {HTMLElement} card @param {HTMLElement} word @param {() => boolean} isWanted  Whether no other word was asked for meanwhile. */
export async function fillCard(card, word, isWanted) {
  const name = word.dataset.term ?? "";
  if (termOf(name)) await explained();
  const own = termOf(name);
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
          meaning(
            "p",
            term ?? { text: texts ? "" : "The text could not be loaded; try again when the network is there." },
          ),
          ...(hint ? [element("p", { class: "range" }, hint)] : []),
        ]),
  );
}
