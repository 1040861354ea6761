/** Moves a button into the topmost modal dialog, so that STOP is always in reach (LIVE H4). */

/** @param {() => boolean} isNeeded @param {HTMLElement} node @param {() => void} home  Puts it back in its own place. */
export function carryInto(isNeeded, node, home) {
  const own = node.closest("dialog");
  /** Modal dialogs, as they were opened. @type {HTMLDialogElement[]} */
  let open = [];
  let isAway = false;
  function place() {
    const top = isNeeded() ? open.at(-1) : undefined;
    const other = top === own ? undefined : top;
    if (other && node.parentElement !== other) other.prepend(node);
    if (!other && isAway) home();
    isAway = other !== undefined;
  }
  const observer = new MutationObserver((records) => {
    const opened = new Set(records.map(({ target }) => target));
    const modal = [...document.querySelectorAll("dialog")].filter((each) => each.matches(":modal"));
    const [later, earlier] = [true, false].map((is) => modal.filter((each) => opened.has(each) === is));
    open = [...open.filter((each) => earlier.includes(each)), ...later];
    place();
  });
  observer.observe(document.body, { subtree: true, attributeFilter: ["open"] });
  return { place, end: () => observer.disconnect() };
}
