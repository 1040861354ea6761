/** Panels whose content loads when they first open. */
import { byId } from "../dom.js";
import { dropDown } from "./popover.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {{isOpen: () => boolean, close: () => void}} Popover */
/** @typedef {{onOpen: () => void, render?: (state: State, before: State | undefined) => void}} Content  `onOpen` is called whenever the panel opens. */

/** The text if its code cannot be loaded. */
const MISSING = "This part of the page could not be loaded. Check the network and try again.";

/** @param {string} button @param {string} panel  Their ids. @param {(popover: Popover) => Promise<Content>} load @param {string} about  Id of the element for error messages. */
export function createLazyPopover(button, panel, load, about) {
  /** @type {Promise<Content> | null} */
  let loading = null;
  /** @type {Content | null} */
  let content = null;
  const message = byId(about);
  // Input before the content is loaded would be lost, so the parts are inert. The panel itself is not: clicks would pass through
  // it, and screen readers would not read the message. A field that has the focus first keeps what is typed.
  /** @type {HTMLElement[]} */
  const parts = Array.from(byId(panel).querySelectorAll(":scope > *"));
  const setInert = (/** @type {boolean} */ isInert) => {
    for (const part of parts) part.inert = isInert && !part.contains(message) && !part.querySelector("[autofocus]");
  };
  setInert(true);
  const own = dropDown(button, panel, async () => {
    try {
      loading ??= load(own);
      content = await loading;
    } catch {
      loading = null;
      message.textContent = MISSING;
      return;
    }
    if (message.textContent === MISSING) message.textContent = "";
    setInert(false);
    content.onOpen();
  });
  return {
    /** @param {State} state @param {State | undefined} before */
    render(state, before) {
      /** @type {HTMLButtonElement} */ (byId(button)).disabled = false;
      content?.render?.(state, before);
    },
  };
}
