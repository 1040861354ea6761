/** Restores the focus after the form was rebuilt. */

/** Elements that can have the focus, in the order of the form. @param {HTMLElement} root @returns {HTMLElement[]} */
const focusable = (root) => [
  .../** @type {NodeListOf<HTMLElement>} */ (
    root.querySelectorAll("button:enabled, input:enabled, select:enabled, textarea:enabled, summary")
  ),
];

/** Saves the focused element: a field by its path, a button by its label. Returns how to restore it. @param {HTMLElement} root @returns {() => void} */
export function saveFocus(root) {
  const active = /** @type {HTMLElement | null} */ (document.activeElement);
  if (!active || !root.contains(active)) return () => {};
  const { path } = active.dataset;
  const selector = path
    ? `[data-path="${CSS.escape(path)}"]`
    : `button[aria-label="${CSS.escape(active.getAttribute("aria-label") ?? "")}"]`;
  const nth = [...root.querySelectorAll(selector)].indexOf(active);
  const position = focusable(root).indexOf(active);
  return () => {
    const same = /** @type {HTMLElement | undefined} */ (root.querySelectorAll(selector)[nth]);
    // If the element was removed, the one at its position gets the focus.
    const all = focusable(root);
    const next = same?.matches(":enabled, summary") ? same : all[Math.min(position, all.length - 1)];
    next?.focus();
  };
}
