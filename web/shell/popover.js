/** Panels that open under a button of the header. The browser closes them on Escape and on a click elsewhere. */
import { byId } from "../dom.js";

/** Minimum distance of a panel from the edge of the window, in CSS pixels. */
const EDGE = 8;
/** Distance between a panel and its button, in CSS pixels. */
const GAP = 4;
/** With less space than this below the button, a panel opens above it, in CSS pixels. */
const MIN_PX = 260;

/**
 * @param {string} button  Id of the button that opens it.
 * @param {string} panel   Id of the panel, an element with `popover`.
 * @param {() => void} [onOpen]  Called when it is about to open.
 */
export function dropDown(button, panel, onOpen = () => {}) {
  const opener = /** @type {HTMLButtonElement} */ (byId(button));
  const box = byId(panel);
  opener.popoverTargetElement = box;
  opener.setAttribute("aria-expanded", "false");
  box.addEventListener("beforetoggle", (event) => {
    const open = /** @type {ToggleEvent} */ (event).newState === "open";
    opener.setAttribute("aria-expanded", String(open));
    if (open) onOpen();
  });
  const place = () => {
    const { right, top, bottom } = opener.getBoundingClientRect();
    const { clientWidth: wide, clientHeight: high } = document.documentElement;
    const [above, under] = [top - GAP - EDGE, high - Math.max(EDGE, bottom + GAP) - EDGE];
    // Above the button if there is too little space below it.
    const over = under < Math.min(box.scrollHeight, MIN_PX) && above > under;
    box.style.top = over ? "auto" : `${Math.max(EDGE, bottom + GAP)}px`;
    box.style.bottom = over ? `${high - top + GAP}px` : "auto";
    box.style.left = `${Math.max(EDGE, Math.min(right, wide - EDGE) - box.offsetWidth)}px`;
    box.style.maxHeight = `${over ? above : under}px`;
  };
  box.addEventListener("toggle", (event) => {
    if (/** @type {ToggleEvent} */ (event).newState === "open") place();
  });
  window.addEventListener("resize", () => {
    if (isOpen()) place();
  });
  const isOpen = () => box.matches(":popover-open");
  return {
    isOpen,
    close: () => {
      if (isOpen()) box.hidePopover();
    },
  };
}
