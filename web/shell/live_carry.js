/**
 * A button that has to be within reach whatever is in front (LIVE H4: STOP first of all): a modal dialog makes all that is outside of
 * it inert, so the button goes into the dialog that was opened last, and back when that closes.
 */

/** @param {() => boolean} isNeeded @param {HTMLElement} node @param {() => void} home  Puts it back in its own place. */
export function carryInto(isNeeded, node, home) {
  const own = node.closest("dialog");
  /** Modal dialogs of others, as they were opened. @type {HTMLDialogElement[]} */
  let open = [];
  let isAway = false;
  function look() {
    const modal = [...document.querySelectorAll("dialog")].filter((each) => each !== own && each.matches(":modal"));
    open = [...open.filter((each) => modal.includes(each)), ...modal.filter((each) => !open.includes(each))];
    const top = isNeeded() ? open.at(-1) : undefined;
    if (top && node.parentElement !== top) top.prepend(node);
    if (!top && isAway) home();
    isAway = top !== undefined;
  }
  const observer = new MutationObserver(look);
  observer.observe(document.body, { subtree: true, childList: true, attributeFilter: ["open"] });
  return { look, end: () => observer.disconnect() };
}
