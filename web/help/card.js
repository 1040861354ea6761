/**
 * The card that a word with dots under it opens: what the word means and which document it comes from. One card serves
 * all of them; a click elsewhere and Escape close it.
 */
import { byId, element, fill } from "../dom.js";
import { CARD, termButton } from "../form/term_button.js";
import { VIEWS } from "../state/views.js";

/** From the word to its card, and from the card to the window's edges, in CSS pixels. */
const GAP_PX = 4;

/** Opens the card of the word that explains an element, if there is one. @param {Element} at */
export function explain(at) {
  const word = /** @type {HTMLElement | null} */ (at.closest(".field, .item")?.querySelector(".term") ?? null);
  if (!word) return false;
  show(word);
  return true;
}

/** Makes the card, and the headings of the views words of it. */
export function createCard() {
  const card = element("div", { id: CARD, class: "term-card", popover: "auto", role: "note", "aria-live": "polite" });
  document.body.append(card);
  // A press anywhere closes the card before the click comes: one on the card's own word must not open it again.
  /** @type {HTMLElement | null} */
  let closing = null;
  document.addEventListener(
    "pointerdown",
    () => {
      closing = card.matches(":popover-open") ? opener : null;
    },
    { capture: true },
  );
  document.addEventListener("click", (event) => {
    const word = /** @type {HTMLElement | null} */ (/** @type {Element} */ (event.target).closest?.(".term"));
    if (word && word !== closing && !(word === opener && card.matches(":popover-open"))) show(word);
    else if (word) card.hidePopover();
    // As a label does: what is typed next goes into its field.
    const field = word?.closest(".field")?.querySelector("input, select, textarea");
    if (field instanceof HTMLElement) field.focus({ preventScroll: true });
    closing = null;
  });
  card.addEventListener("toggle", (event) => {
    const open = /** @type {ToggleEvent} */ (event).newState === "open";
    opener?.setAttribute("aria-expanded", String(open));
  });
  for (const { name, title } of VIEWS) fill(byId(`title-${name}`), termButton(title, `view:${name}`));
}

/** The word whose card is on show, or was last. @type {HTMLElement | null} */
let opener = null;

/** What fills the card; it loads with the first. @type {Promise<typeof import("./filled.js")> | null} */
let loading = null;

/** Fills the card for a word and shows it there. @param {HTMLElement} word */
async function show(word) {
  const card = document.getElementById(CARD);
  if (!card) return;
  if (opener !== word) opener?.setAttribute("aria-expanded", "false");
  opener = word;
  const isWanted = () => opener === word && word.isConnected;
  try {
    loading ??= import("./filled.js");
    await (await loading).fillCard(card, word, isWanted);
  } catch {
    loading = null;
    if (isWanted()) fill(card, element("p", {}, "The text could not be loaded; try again when the network is there."));
  }
  // Another word was asked for meanwhile.
  if (!isWanted()) return;
  card.hidePopover();
  card.showPopover();
  place(card, word);
  word.setAttribute("aria-expanded", "true");
}

/** Puts the card under its word, or above it where there is more room. @param {HTMLElement} card @param {HTMLElement} word */
function place(card, word) {
  const { left, top, bottom } = word.getBoundingClientRect();
  const { width, height } = card.getBoundingClientRect();
  const room = document.documentElement;
  const under = bottom + GAP_PX;
  const above = top - GAP_PX - height;
  card.style.left = `${Math.max(GAP_PX, Math.min(left, room.clientWidth - width - GAP_PX))}px`;
  card.style.top = `${Math.max(GAP_PX, under + height <= room.clientHeight || above < GAP_PX ? Math.min(under, room.clientHeight - height - GAP_PX) : above)}px`;
}
