/** Moves a button into the topmost modal dialog, so that STOP is always in reach (LIVE H4). */

/** @param {() => boolean} isNeeded @param {HTMLElement} node @param {() => void} moveBack  Moves it back to its own dialog. */
export function carryInto(isNeeded, node, moveBack) {
  const own = node.closest("dialog");
  /** Modal dialogs, in the order of their opening. @type {HTMLDialogElement[]} */
  let open = [];
  let isAway = false;
  function update() {
    const top = isNeeded() ? open.at(-1) : undefined;
    const other = top === own ? undefined : top;
    if (other && node.parentElement !== other) other.prepend(node);
    if (!other && isAway) moveBack();
    isAway = other !== undefined;
  }
  const observer = new MutationObserver((records) => {
    const opened = new Set(records.map(({ target }) => target));
    const modal = [...document.querySelectorAll("dialog")].filter((each) => each.matches(":modal"));
    const [later, earlier] = [true, false].map((is) => modal.filter((each) => opened.has(each) === is));
    open = [...open.filter((each) => earlier.includes(each)), ...later];
    update();
  });
  observer.observe(document.body, { subtree: true, attributeFilter: ["open"] });
  return { update, end: () => observer.disconnect() };
}
