/** The help card of a term: its meaning and its source. All terms share one card. */
import { byId, element, fill } from "../dom.js";
import { CARD, termButton } from "../form/term_button.js";
import { VIEWS } from "../state/views.js";

/** Distance of a card from its word and from the edge of the window, in CSS pixels. */
const GAP_PX = 4;

/** Opens the help card of an element. Returns whether it has one. @param {Element} at */
export function explain(at) {
  const word = /** @type {HTMLElement | null} */ (at.closest(".field, .item")?.querySelector(".term") ?? null);
  if (!word) return false;
  show(word);
  return true;
}

/** Creates the card, and makes the headings of the views terms. */
export function createCard() {
  const card = element("div", { id: CARD, class: "term-card", popover: "auto", role: "note", "aria-live": "polite" });
  document.body.append(card);
  // A press closes the card before its click arrives, so that a click on the same term does not reopen it.
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
    // Like a label, the term moves the focus to its field.
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

/** The term of the current or last card. @type {HTMLElement | null} */
let opener = null;

/** Loaded with the first card. @type {Promise<typeof import("./card_content.js")> | null} */
let loading = null;

/** Shows the card of a term. @param {HTMLElement} word */
async function show(word) {
  const card = document.getElementById(CARD);
  if (!card) return;
  if (opener !== word) opener?.setAttribute("aria-expanded", "false");
  opener = word;
  const isWanted = () => opener === word && word.isConnected;
  try {
    loading ??= import("./card_content.js");
    await (await loading).fillCard(card, word, isWanted);
  } catch {
    loading = null;
    if (isWanted()) fill(card, element("p", {}, "The text could not be loaded. Check the network and try again."));
  }
  // Another term was requested meanwhile.
  if (!isWanted()) return;
  card.hidePopover();
  card.showPopover();
  place(card, word);
  word.setAttribute("aria-expanded", "true");
}

/** Places the card below its word, or above it if there is more page. @param {HTMLElement} card @param {HTMLElement} word */
function place(card, word) {
  const { left, top, bottom } = word.getBoundingClientRect();
  const { width, height } = card.getBoundingClientRect();
  const page = document.documentElement;
  const below = bottom + GAP_PX;
  const above = top - GAP_PX - height;
  card.style.left = `${Math.max(GAP_PX, Math.min(left, page.clientWidth - width - GAP_PX))}px`;
  card.style.top = `${Math.max(GAP_PX, below + height <= page.clientHeight || above < GAP_PX ? Math.min(below, page.clientHeight - height - GAP_PX) : above)}px`;
}
