/** Panels of the header whose content loads when they are first opened. */
import { byId } from "../dom.js";
import { dropDown } from "./popover.js";

/** @typedef {import("../state/types.js").State} State */
/** @typedef {{isOpen: () => boolean, close: () => void}} Panel */
/** @typedef {{opened: () => void, render?: (state: State, before: State | undefined) => void}} Content  `opened` is called whenever the panel opens. */

/** @param {string} button @param {string} panel  Their ids. @param {(panel: Panel) => Promise<Content>} load @param {string} about  Id of the element that says what went wrong. */
export function createPanel(button, panel, load, about) {
  /** @type {Content | null} */
  let content = null;
  const place = byId(panel);
  // What is typed before there is anyone to take it would be lost.
  place.inert = true;
  const own = dropDown(button, panel, async () => {
    try {
      content ??= await load(own);
      content.opened();
    } catch {
      byId(about).textContent = "This part of the page could not be loaded; try again when the network is there.";
    }
    place.inert = false;
  });
  return {
    /** @param {State} state @param {State | undefined} before */
    render(state, before) {
      /** @type {HTMLButtonElement} */ (byId(button)).disabled = false;
      content?.render?.(state, before);
    },
  };
}
